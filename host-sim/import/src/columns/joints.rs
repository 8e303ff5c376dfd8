//! Columns of a JointState: one per joint and quantity (`/joint_states/wheel_left/position`, as by PlotJuggler), or numbered ones
//! beside the names of the joints (`position_0` and `name_0`, as by bagpy and `rostopic echo -p`).

use std::collections::BTreeMap;

use crate::column::Column;
use crate::joints::wheels;
use crate::left_out::LeftOut;
use crate::quantities::{Dimension, Unit};
use crate::table::Table;

/// The columns of joints in a table.
#[derive(Default)]
pub struct Joints {
    /// Angles of the left and of the right wheels.
    pub counters: [Vec<Column>; 2],
    /// The other columns, with the reason.
    pub left_out: Vec<LeftOut>,
    /// Indices of all columns of joints.
    pub indices: Vec<usize>,
}

const POSITION: &str = "position";
/// What a JointState has beside positions.
const OTHERS: [&str; 2] = ["velocity", "effort"];
const CHOOSE: &str = "assign rot_left and rot_right in a --map file";
/// The angles of joints are in radians.
const RAD: Unit = Unit { dimension: Dimension::Angle, factor: 1.0 };

/// Finds the columns of joints.
pub fn find(table: &Table) -> Joints {
    let mut joints = Joints::default();
    // The joints by topic, with the index of the column of their position.
    let mut by_topic: BTreeMap<String, Vec<(String, usize)>> = BTreeMap::new();
    let first_row = table.first_row();
    for (index, name) in table.names().iter().enumerate() {
        let Some((topic, joint)) = joint(table, &first_row, name) else { continue };
        by_topic.entry(topic).or_default().push((joint, index));
        let siblings = OTHERS.iter().map(|other| name.replace(POSITION, other));
        for sibling in siblings.filter_map(|sibling| table.names().iter().position(|name| *name == sibling)) {
            joints.indices.push(sibling);
            joints.left_out.push(LeftOut::column(&table.names()[sibling], "of a joint whose position is used"));
        }
        joints.indices.push(index);
    }
    let of_topic = |joints: &[(String, usize)]| wheels(joints.iter().map(|(joint, _)| joint.as_str()));
    let with_wheels = by_topic.values().filter(|joints| of_topic(joints).is_some()).count();
    for all in by_topic.values() {
        let found = of_topic(all).filter(|_| with_wheels == 1).unwrap_or_default();
        for (joint, index) in all {
            let name = &table.names()[*index];
            match found.iter().position(|side| side.contains(joint)) {
                Some(side) => joints.counters[side].push(Column::of(*index, name, Some(RAD))),
                None if with_wheels > 1 => {
                    joints.left_out.push(LeftOut::column(name, format!("wheels are in several topics; {CHOOSE}")));
                }
                None => {
                    let reason = format!("joint {joint} is not taken for a driven wheel; {CHOOSE}");
                    joints.left_out.push(LeftOut::column(name, reason));
                }
            }
        }
    }
    joints
}

/// Returns topic and joint of a column with the position of a joint.
fn joint(table: &Table, first_row: &[String], name: &str) -> Option<(String, String)> {
    let (path, last) = name.rsplit_once(['/', '.']).unwrap_or(("", name));
    if last == POSITION {
        let (topic, joint) = path.rsplit_once(['/', '.']).unwrap_or(("", path));
        let is_of_joint = OTHERS.iter().any(|other| table.names().contains(&name.replace(POSITION, other)))
            || topic.contains("joint");
        return (is_of_joint && !joint.is_empty()).then(|| (topic.into(), joint.into()));
    }
    let number = last.strip_prefix(POSITION)?;
    let is_number = number.trim_matches(['_', '[', ']']).parse::<u16>().is_ok();
    let of_name = name[..name.len() - last.len()].to_owned() + "name" + number;
    let joint = table.names().iter().position(|name| is_number && *name == of_name)?;
    Some((path.into(), first_row.get(joint).filter(|joint| !joint.is_empty())?.clone()))
}
