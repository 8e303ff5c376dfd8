//! A ROS 2 bag of speed commands, to drive a simulator with.

use std::collections::BTreeMap;
use std::io::Cursor;

use mcap::records::MessageHeader;
use mcap::{WriteOptions, Writer};

/// Type of the messages.
const TYPE: &str = "geometry_msgs/msg/Twist";
/// Its definition.
const DEFINITION: &str = "Vector3 linear\nVector3 angular\n\
    ================================================================================\n\
    MSG: geometry_msgs/Vector3\nfloat64 x\nfloat64 y\nfloat64 z\n";
/// Header of little-endian CDR.
const CDR: [u8; 4] = [0, 1, 0, 0];

/// Returns the bytes of a bag with one topic. Commands are time, ms, with forward speed, m/s, and turn rate, rad/s.
pub fn of(topic: &str, commands: &[(f64, [f64; 2])]) -> Vec<u8> {
    let mut file = Cursor::new(Vec::new());
    write(&mut file, topic, commands).expect("writing to memory does not fail");
    file.into_inner()
}

fn write(file: &mut Cursor<Vec<u8>>, topic: &str, commands: &[(f64, [f64; 2])]) -> mcap::McapResult<()> {
    let options = WriteOptions::new().profile("ros2").compression(None);
    let mut writer = Writer::with_options(file, options)?;
    let schema = writer.add_schema(TYPE, "ros2msg", DEFINITION.as_bytes())?;
    let channel = writer.add_channel(schema, topic, "cdr", &BTreeMap::new())?;
    for ((t_ms, [forward_m_s, turn_rad_s]), sequence) in commands.iter().zip(0..) {
        let mut data: Vec<u8> = CDR.to_vec();
        for number in [*forward_m_s, 0.0, 0.0, 0.0, 0.0, *turn_rad_s] {
            data.extend(number.to_le_bytes());
        }
        let time = (t_ms * 1e6) as u64;
        let header = MessageHeader { channel_id: channel, sequence, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, &data)?;
    }
    writer.finish()?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_are_read_back() {
        let bytes = of("/cmd_vel", &[(0.0, [0.25, -1.0]), (400.0, [0.0, 0.0])]);
        let messages: Vec<mcap::Message> =
            mcap::MessageStream::new(&bytes).expect("a bag").map(|m| m.expect("a message")).collect();
        assert_eq!((messages.len(), messages[1].log_time), (2, 400_000_000));
        assert_eq!(messages[0].data[4..12], 0.25f64.to_le_bytes());
        assert_eq!(messages[0].data[44..52], (-1.0f64).to_le_bytes());
    }
}
