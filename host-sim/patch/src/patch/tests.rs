use std::collections::BTreeMap;
use std::path::Path;

use super::*;
use crate::estimate::Estimate;
use mindgap_models::effects::parameter::{ActsOn, Side};

const URDF: &str = r#"<?xml version="1.0"?>
<robot name="cart"><!-- 0.063 -->
  <link name="base"><inertial><origin xyz="0 0 0.01"/><mass value="1.5"/></inertial><collision><geometry><box size="1 1 1"/></geometry></collision></link>
  <link name="lw"><collision><geometry><cylinder length="0.02" radius="0.0315"/></geometry></collision></link>
  <link name="rw"><collision><geometry><cylinder radius='0.0315' length='0.02'/></geometry></collision></link>
  <link name="eye"/>
  <joint name="lj" type="continuous"><parent link="base"/><child link="lw"/><origin xyz="0 0.081  0" rpy="-1.57 0 0"/></joint>
  <joint name="rj" type="continuous"><parent link="base"/><child link="rw"/><origin xyz="0 -0.081 0"/></joint>
  <joint name="ej" type="fixed"><parent link="base"/><child link="eye"/><origin xyz="0.07 0 0.04"/></joint>
  <gazebo><plugin filename="libgazebo_ros_diff_drive.so" name="d">
    <wheel_separation>0.162</wheel_separation><wheel_diameter>0.063</wheel_diameter>
    <max_wheel_acceleration> 1.9 </max_wheel_acceleration>
    <left_joint>lj</left_joint><right_joint>rj</right_joint>
  </plugin></gazebo>
  <gazebo reference="eye"><sensor name="s" type="ray"><update_rate>10</update_rate><ray>
    <scan><horizontal><min_angle>-0.09</min_angle><max_angle>0.09</max_angle></horizontal></scan>
    <noise><type>gaussian</type><mean>0.0</mean><stddev>0.007</stddev></noise></ray></sensor></gazebo>
</robot>
"#;

const SDF: &str = r#"<sdf version="1.9"><model name="cart">
  <link name="base"><inertial><mass>1.5</mass></inertial>
    <sensor name="s" type="gpu_lidar"><pose degrees="true">0.07 0 0.04 0 0 5</pose><lidar><scan/></lidar></sensor></link>
  <link name="lw"><pose relative_to="base">0 0.08 0 -1.57 0 0</pose><collision name="c"><geometry><sphere><radius>0.03</radius></sphere></geometry></collision></link>
  <link name="rw"><pose>0 -0.08 0 -1.57 0 0</pose><collision name="c"><geometry><sphere><radius>0.03</radius></sphere></geometry></collision></link>
  <joint name="lj" type="revolute"><parent>base</parent><child>lw</child></joint>
  <joint name="rj" type="revolute"><parent>base</parent><child>rw</child></joint>
  <plugin filename="gz-sim-diff-drive-system" name="d"><left_joint>lj</left_joint><right_joint>rj</right_joint>
    <wheel_separation>0.16</wheel_separation><wheel_radius>0.03</wheel_radius><max_linear_acceleration>1</max_linear_acceleration></plugin>
</model></sdf>
"#;

const MJCF: &str = r#"<mujoco>
  <option timestep="0.002"/>
  <default><velocity kv="0.02"/><joint armature="0.0004"/></default>
  <worldbody><body name="base"><freejoint/>
    <geom type="box" size="0.1 0.1 0.1" mass="1.2"/>
    <site name="eye" pos="0.08 0 0.03" euler="0 90 0"/>
    <body pos="0 0.0725 0"><joint name="wheel_l" frictionloss="0.006"/><geom type="cylinder" size="0.034 0.008"/></body>
    <body pos="0 -0.0725 0"><joint name="wheel_r" frictionloss="0.006"/><geom type="cylinder" size="0.034 0.008"/></body>
  </body></worldbody>
  <actuator><velocity name="l" joint="wheel_l" ctrlrange="-14 14"/>
    <velocity name="r" joint="wheel_r" kv="0.018" ctrlrange="-14 14"></velocity></actuator>
  <sensor><rangefinder site="eye" cutoff="2.2"/></sensor>
</mujoco>
"#;

const WEBOTS: &str = r#"#VRML_SIM R2025a utf8
Robot { children [
  DistanceSensor { lookupTable [ 0 0 0, 2 2 0.01 ] aperture 0.2 }
  HingeJoint { jointParameters HingeJointParameters { axis 0 1 0 anchor 0 0.08 0.03 } device RotationalMotor { name "left wheel" maxVelocity 20 }
    endPoint Solid { translation 0 0.08 0.03 boundingObject Pose { children DEF TYRE Cylinder { radius 0.03 height 0.01 } } } }
  HingeJoint { jointParameters HingeJointParameters { axis 0 1 0 anchor 0 -0.08 0.03 } device [ RotationalMotor { name "right wheel" } ]
    endPoint Solid { translation 0 -0.08 0.03 boundingObject USE TYRE } }
  ] }
"#;

const YAML: &str = "diff_drive_controller:\n  ros__parameters:\n    wheel_separation: 0.16  # m, with a \u{2013}\n    wheel_radius: 0.03\n    \
                    wheel_separation_multiplier: 1.0\n    linear.x.max_acceleration: 1.0\n    angular:\n      z: {max_acceleration: 2.0}\n";

fn robot() -> Robot {
    Robot { track_cm: 16.0, full_speed_cm_s: 36.0, wheel_diameter_cm: 6.0, ..mindgap_built_in_robot::default_robot() }
}

fn cause(effect: &str, numbers: &[(&str, f64)]) -> Cause {
    let estimate = |value: f64| Estimate { value, ci95: Some([value - 0.01, value + 0.01]) };
    let numbers: BTreeMap<String, Estimate> =
        numbers.iter().map(|(name, value)| ((*name).to_owned(), estimate(*value))).collect();
    Cause {
        effect: effect.into(),
        share: Some(0.5),
        numbers,
        side: Some(Side::Right),
        sensor: None,
        acts_on: Some(ActsOn::Wheel),
    }
}

fn patched_by(file: &str, text: &str, cause: &Cause, engine: Option<Engine>) -> Patched {
    let model = Model::new(Path::new(file), text.into(), &robot()).expect("a model");
    patch(&[(model, "out".into())], std::slice::from_ref(cause), &robot(), engine)
}

/// Asserts that exactly these pieces of a file are replaced, each once.
fn assert_replaced(file: &str, text: &str, cause: &Cause, replaced: &[(&str, &str)]) {
    let patched = patched_by(file, text, cause, None);
    assert_eq!(patched.not_patched, [], "{}", cause.effect);
    let mut expected = text.to_owned();
    for (old, new) in replaced {
        assert!(expected.contains(old), "{old} is in {file}");
        expected = expected.replacen(old, new, 1);
    }
    assert_eq!(patched.texts, [expected], "{} in {file}", cause.effect);
    assert!(patched.patches.iter().all(|patch| patch.effect == cause.effect && patch.file == Path::new("out")));
}

fn reason(file: &str, text: &str, cause: &Cause, engine: Option<Engine>) -> String {
    let patched = patched_by(file, text, cause, engine);
    assert_eq!((patched.texts, patched.patches), (vec![text.to_owned()], vec![]), "{} in {file}", cause.effect);
    patched.not_patched[0].reason.clone()
}

#[test]
fn urdf_has_wheels_track_sensor_and_plugin() {
    let replaced = |cause: Cause, pairs: &[(&str, &str)]| assert_replaced("a.urdf", URDF, &cause, pairs);
    replaced(
        cause("drive_scale", &[("factor", 0.5)]),
        &[("radius=\"0.0315", "radius=\"0.01575"), ("radius='0.0315", "radius='0.01575")],
    );
    replaced(cause("track_width", &[("factor", 0.9)]), &[("0 0.081  0", "0 0.09  0"), ("0 -0.081 0", "0 -0.09 0")]);
    replaced(cause("sonar_offset", &[("cm", -5.0)]), &[("<mean>0.0<", "<mean>-0.05<")]);
    replaced(cause("sonar_noise", &[("cm", 2.4)]), &[("<stddev>0.007<", "<stddev>0.025<")]);
    replaced(cause("sonar_beam", &[("factor", 2.0)]), &[("-0.09<", "-0.18<"), (">0.09<", ">0.18<")]);
    replaced(cause("sonar_lag", &[("steps", 0.5)]), &[("<update_rate>10<", "<update_rate>2<")]);
    let yaw = 10f64.to_radians().to_string();
    replaced(
        cause("sonar_yaw", &[("deg", 10.0)]),
        &[("0.07 0 0.04\"", &format!("0.07 0 0.04\" rpy=\"0 0 {}\"", &yaw[..14]))],
    );
    replaced(cause("rate_limit", &[("cm_s2", 120.0)]), &[(" 1.9 ", " 1.2 ")]);
    replaced(cause("payload", &[("mass_share", 0.2), ("lateral", 0.0)]), &[("mass value=\"1.5", "mass value=\"1.8")]);
}

#[test]
fn urdf_says_what_it_has_no_tag_for() {
    for effect in [
        "latency",
        "motor_asymmetry",
        "inertia",
        "deadband",
        "saturation",
        "slip",
        "battery_sag",
        "sonar_ghost",
        "tracker_scale",
    ] {
        let numbers = [
            ("ms", 160.0),
            ("factor", 0.9),
            ("command", 8.0),
            ("probability", 0.1),
            ("cm", 9.0),
            ("loss_per_min", 0.1),
        ];
        assert!(!reason("a.urdf", URDF, &cause(effect, &numbers), None).is_empty(), "{effect}");
    }
    let deadband = cause("deadband", &[("command", 8.0)]);
    assert!(reason("a.urdf", URDF, &deadband, Some(Engine::PyBullet)).contains("no effect in pybullet"));
    let small = Cause { share: Some(0.04), ..cause("drive_scale", &[("factor", 0.9)]) };
    assert!(reason("a.urdf", URDF, &small, None).contains("4.0 % of the gap"));
}

#[test]
fn sdf_has_wheels_track_sensor_and_plugin() {
    let replaced = |cause: Cause, pairs: &[(&str, &str)]| assert_replaced("a.sdf", SDF, &cause, pairs);
    replaced(cause("track_width", &[("factor", 0.8)]), &[("0 0.08 0", "0 0.1 0"), ("0 -0.08 0", "0 -0.1 0")]);
    replaced(
        cause("drive_scale", &[("factor", 2.0)]),
        &[("<radius>0.03<", "<radius>0.06<"), ("<radius>0.03<", "<radius>0.06<")],
    );
    let last = SDF.rfind("<radius>0.03<").expect("the right wheel");
    let patched = patched_by("a.sdf", SDF, &cause("motor_asymmetry", &[("factor", 0.9)]), None);
    assert_eq!(patched.texts[0], format!("{}<radius>0.027<{}", &SDF[..last], &SDF[last + 13..]));
    replaced(cause("sonar_yaw", &[("deg", -7.5)]), &[("0.04 0 0 5", "0.04 0 0 -2.5")]);
    let noise = "<lidar><noise><type>gaussian</type><mean>0.05</mean><stddev>0</stddev></noise><scan/>";
    replaced(cause("sonar_offset", &[("cm", 5.0)]), &[("<lidar><scan/>", noise)]);
    let ramp = Cause { acts_on: Some(ActsOn::Twist), ..cause("rate_limit", &[("cm_s2", 50.0), ("deg_s2", 90.0)]) };
    let patched = patched_by("a.sdf", SDF, &ramp, None);
    assert!(patched.texts[0].contains("<max_linear_acceleration>0.5<"), "{}", patched.texts[0]);
    assert!(patched.texts[0].contains("<max_angular_acceleration>1.57079632679<"), "{}", patched.texts[0]);
    assert!(
        reason("a.sdf", SDF, &cause("deadband", &[("command", 8.0)]), Some(Engine::Drake))
            .contains("no effect in drake")
    );
}

#[test]
fn mjcf_has_wheels_servos_joints_and_sites() {
    let replaced = |cause: Cause, pairs: &[(&str, &str)]| assert_replaced("a.xml", MJCF, &cause, pairs);
    replaced(cause("track_width", &[("factor", 0.5)]), &[("0 0.0725 0", "0 0.145 0"), ("0 -0.0725 0", "0 -0.145 0")]);
    replaced(
        cause("drive_scale", &[("factor", 0.5)]),
        &[("size=\"0.034", "size=\"0.017"), ("size=\"0.034", "size=\"0.017")],
    );
    let servo = "<general name=\"r\" joint=\"wheel_r\" gainprm=\"0.0162\" biastype=\"affine\" biasprm=\"0 0 -0.018\" ctrlrange=\"-14 14\"></general>";
    replaced(
        cause("motor_asymmetry", &[("factor", 0.9)]),
        &[("<velocity name=\"r\" joint=\"wheel_r\" kv=\"0.018\" ctrlrange=\"-14 14\"></velocity>", servo)],
    );
    // 12 rad/s at full command, and a gain of 0.02.
    replaced(
        cause("deadband", &[("command", 10.0)]),
        &[("loss=\"0.006", "loss=\"0.03"), ("loss=\"0.006", "loss=\"0.03")],
    );
    replaced(cause("inertia", &[("ms", 30.0)]), &[("armature=\"0.0004", "armature=\"0.001")]);
    replaced(cause("saturation", &[("command", 50.0)]), &[("-14 14", "-6 6"), ("-14 14", "-6 6")]);
    let delay = "ctrlrange=\"-14 14\" delay=\"0.16\" nsample=\"81\"";
    replaced(
        cause("latency", &[("ms", 160.0)]),
        &[("ctrlrange=\"-14 14\"/", &format!("{delay}/")), ("ctrlrange=\"-14 14\">", &format!("{delay}>"))],
    );
    replaced(cause("sonar_yaw", &[("deg", 7.0)]), &[("0 90 0", "-90 83 90")]);
    replaced(cause("sonar_offset", &[("cm", 3.0)]), &[("0.08 0 0.03", "0.05 0 0.03")]);
    assert!(
        reason("a.xml", MJCF, &cause("deadband", &[("command", 8.0)]), Some(Engine::Drake)).contains("frictionloss")
    );
    assert!(reason("a.xml", MJCF, &cause("sonar_noise", &[("cm", 8.0)]), None).contains("driver"));
}

#[test]
fn mjcf_class_that_others_share_is_left_alone() {
    let text = MJCF.replace("<freejoint/>", "<freejoint/><body><joint name=\"arm\"/><geom size=\"0.1\"/></body>");
    let patched = patched_by("a.xml", &text, &cause("inertia", &[("ms", 30.0)]), None);
    assert_eq!(
        patched.texts[0].matches("frictionloss=\"0.006\" armature=\"0.001\"").count(),
        2,
        "{}",
        patched.texts[0]
    );
    assert!(patched.texts[0].contains("<joint armature=\"0.0004\"/>"));
}

#[test]
fn webots_has_wheels_motors_and_tables() {
    let replaced = |cause: Cause, pairs: &[(&str, &str)]| assert_replaced("a.wbt", WEBOTS, &cause, pairs);
    let twice = |side: &'static str, new: &'static str| [(side, new), (side, new)];
    replaced(
        cause("track_width", &[("factor", 0.5)]),
        &[twice("0 0.08 0.03", "0 0.16 0.03"), twice("0 -0.08 0.03", "0 -0.16 0.03")].concat(),
    );
    replaced(cause("drive_scale", &[("factor", 0.5)]), &[("radius 0.03", "radius 0.015")]);
    replaced(
        cause("saturation", &[("command", 50.0)]),
        &[
            ("maxVelocity 20", "maxVelocity 6"),
            ("RotationalMotor { name \"right", "RotationalMotor { maxVelocity 6 name \"right"),
        ],
    );
    replaced(cause("sonar_beam", &[("factor", 2.0)]), &[("aperture 0.2", "aperture 0.4")]);
    replaced(cause("sonar_offset", &[("cm", 5.0)]), &[("0 0 0, 2 2 0.01", "0 0.05 0, 2 2.05 0.01")]);
    replaced(cause("sonar_scale", &[("factor", 1.1)]), &[("2 2 0.01", "2 2.2 0.01")]);
    let turned = format!("DistanceSensor {{ rotation 0 0 1 {}", &10f64.to_radians().to_string()[..14]);
    replaced(cause("sonar_yaw", &[("deg", 10.0)]), &[("DistanceSensor {", &turned)]);
    assert!(reason("a.wbt", WEBOTS, &cause("motor_asymmetry", &[("factor", 0.9)]), None).contains("share one shape"));
}

#[test]
fn controllers_have_multipliers_and_limits() {
    let replaced = |cause: Cause, pairs: &[(&str, &str)]| assert_replaced("a.yaml", YAML, &cause, pairs);
    replaced(cause("track_width", &[("factor", 0.5)]), &[("multiplier: 1.0", "multiplier: 0.5")]);
    replaced(
        cause("motor_asymmetry", &[("factor", 0.8)]),
        &[("    wheel_radius", "    right_wheel_radius_multiplier: 1.25\n    wheel_radius")],
    );
    let ramp = Cause { acts_on: Some(ActsOn::Twist), ..cause("rate_limit", &[("cm_s2", 50.0), ("deg_s2", 180.0)]) };
    replaced(
        ramp,
        &[
            ("x.max_acceleration: 1.0", "x.max_acceleration: 0.5"),
            ("{max_acceleration: 2.0}", "{max_acceleration: 3.14159265359}"),
        ],
    );
}

#[test]
fn robot_toml_has_speed_track_and_sensor() {
    let text = robot().to_text();
    let patched = |effect: &str, name: &str, value: f64| {
        patched_by("robot.toml", &text, &cause(effect, &[(name, value)]), None).texts
    };
    assert_eq!(patched("drive_scale", "factor", 0.5), [text.replace("full_speed_cm_s = 36.0", "full_speed_cm_s = 18")]);
    assert_eq!(patched("track_width", "factor", 0.8), [text.replace("track_cm = 16.0", "track_cm = 20")]);
}

#[test]
fn a_cause_goes_into_the_first_file_that_has_a_tag_for_it_and_into_no_other() {
    let model =
        |file: &str, text: &str| (Model::new(Path::new(file), text.into(), &robot()).expect("a model"), file.into());
    let models = [model("a.urdf", URDF), model("a.yaml", YAML)];
    let causes = [cause("track_width", &[("factor", 0.9)]), cause("motor_asymmetry", &[("factor", 0.8)])];
    let mut patched = patch(&models, &causes, &robot(), None);
    let files: Vec<_> = patched.patches.iter().map(|patch| patch.file.display().to_string()).collect();
    assert_eq!((files, patched.not_patched.len()), (["a.urdf", "a.urdf", "a.yaml"].map(String::from).to_vec(), 0));
    patched.withdraw(&models, "it is no nearer");
    assert_eq!((patched.texts, patched.patches), (vec![URDF.to_owned(), YAML.to_owned()], vec![]));
    assert_eq!(patched.not_patched.len(), 2);
}

#[test]
fn without_a_model_no_cause_is_left_out() {
    let patched = patch(&[], &[cause("drive_scale", &[("factor", 0.5)])], &robot(), None);
    assert_eq!((patched.patches, patched.not_patched), (vec![], vec![]));
}

#[test]
fn intervals_are_in_the_unit_of_the_tag() {
    let patched = patched_by("a.urdf", URDF, &cause("track_width", &[("factor", 0.9)]), None);
    let [low, high] = patched.patches[1].ci95.expect("an interval");
    assert!((low + 0.081 / 0.89).abs() < 1e-9 && (high + 0.081 / 0.91).abs() < 1e-9, "{low} {high}");
    assert_eq!(patched.patches[1].tag, "/robot/joint[@name='rj']/origin/@xyz");
}

#[test]
fn bad_models_are_refused_in_one_line() {
    let refused = |file: &str, text: &str| {
        Model::new(Path::new(file), text.into(), &robot()).map(|_| ()).expect_err("bad").to_string()
    };
    let xacro = URDF.replace("<robot ", "<robot xmlns:xacro=\"http://www.ros.org/wiki/xacro\" ");
    let xacro = xacro.replace("  <link name=\"eye\"/>", "  <xacro:property name=\"r\" value=\"1\"/>");
    assert!(
        refused("a.urdf", &xacro).contains("a.urdf:6: is xacro: expand it with `xacro FILE"),
        "{}",
        refused("a.urdf", &xacro)
    );
    assert!(refused("a.urdf", &URDF.replace("<left_joint>lj", "<left_joint>nj")).contains("names joint nj"));
    assert!(
        refused("a.urdf", &URDF.replace("0 0.081  0", "0 81 0").replace("0 -0.081 0", "0 -81 0")).contains("162 apart")
    );
    assert!(refused("a.xml", "<mujoco>\n<include file=\"b.xml\"/></mujoco>").contains("a.xml:2: includes b.xml"));
    assert!(
        refused("a.sdf", "<sdf><model><include><uri>model://b</uri></include></model></sdf>")
            .contains("includes model://b")
    );
    assert!(refused("a.wbt", "#VRML_SIM\nRobot {").contains("a.wbt:2: "));
    assert!(refused("a.yaml", "a: [1").contains("a.yaml:"));
    assert!(refused("a.yaml", "a: 1").contains("no wheel_separation"));
    assert!(refused("a.stl", "solid").contains("is not a model file"));
    assert!(refused("a.xml", "<world/>").contains("<world> is not a model"));
    assert!(refused("a.urdf", "<robot>").contains("a.urdf:1: "));
}

#[test]
fn truncated_models_are_errors_and_never_panics() {
    for (file, text) in [("a.urdf", URDF), ("a.sdf", SDF), ("a.xml", MJCF), ("a.wbt", WEBOTS), ("a.yaml", YAML)] {
        for end in (0..text.len()).filter(|end| text.is_char_boundary(*end)) {
            if let Ok(model) = Model::new(Path::new(file), text[..end].into(), &robot()) {
                let all = [
                    cause("track_width", &[("factor", 0.9)]),
                    cause("drive_scale", &[("factor", 0.9)]),
                    cause("sonar_yaw", &[("deg", 9.0)]),
                ];
                let _ = patch(&[(model, "out".into())], &all, &robot(), None);
            }
        }
    }
}
