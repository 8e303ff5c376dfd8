//! The catalogue of all effects: id, description and scales.

use std::fmt;
use std::str::FromStr;

use super::entry::Entry;
use super::{HeldOut, Scale};
use mindgap_files as files;

/// Defines the enum and its entries from one list, so that they stay consistent.
macro_rules! catalogue {
    ($($table:ident $effect:ident $id:literal $about:literal $strength:expr, $detail:expr;)*) => {
        /// A deviation of the built-in robot from its healthy state.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Effect {
            $(#[doc = $about] $effect,)*
            /// A held-out effect.
            HeldOut(HeldOut),
        }

        const LISTED: &[Effect] = &[$(Effect::$effect),*];

        impl Effect {
            fn entry(self) -> Entry {
                match self {
                    $(Effect::$effect => Entry {
                        id: $id,
                        about: $about,
                        in_table: catalogue!(@$table),
                        strength: $strength,
                        detail: $detail,
                    },)*
                    Effect::HeldOut(effect) => effect.entry(),
                }
            }
        }
    };
    (@table) => { true };
    (@other) => { false };
}

const SIDE: &str = "fraction of speed lost on the left; negative: on the right";

catalogue! {
    table BatterySag "battery_sag" "The battery fades as current is drawn from it."
        Scale::rising("fraction of speed lost per minute", 0.1, 0.35, 0.8), None;
    table MotorAsymmetry "motor_asymmetry" "One motor's bridge passes less of the voltage."
        Scale::signed(SIDE, 0.03, 0.12, 0.25), None;
    table DriveScale "drive_scale" "Tyres with a different diameter."
        Scale::factor("factor on distance covered", 0.8, 0.9, 1.2, 0.03), None;
    table TrackWidth "track_width" "The tyres touch the floor closer together or farther apart."
        Scale::factor("factor on turns", 0.75, 0.87, 1.25, 0.04), None;
    table Deadband "deadband" "Dry friction in the gears."
        Scale::rising("command at which a motor breaks away", 9.0, 18.0, 35.0), None;
    table Saturation "saturation" "The bridges limit the voltage."
        Scale::falling("command above which speed no longer rises", 35.0, 60.0, 100.0, 15.0), None;
    table Latency "latency" "Commands reach the motors late."
        Scale::rising("ms", 30.0, 100.0, 250.0), None;
    table Inertia "inertia" "Flywheels on the motors' shafts."
        Scale::rising("ms added to the time constant", 30.0, 120.0, 300.0), None;
    table Payload "payload" "A mass on top of one wheel."
        Scale::signed(SIDE, 0.02, 0.08, 0.16), None;
    table Slope "slope" "The floor is tilted."
        Scale::rising("fraction of speed lost straight uphill at half power", 0.02, 0.08, 0.2),
        Some(Scale::free("direction of downhill in degrees", -180.0, 30.0, 180.0));
    table Slip "slip" "Tyres with little grip on this floor."
        Scale::falling("change of command at which they start to slide", 20.0, 40.0, 100.0, 40.0), None;
    table CarpetNap "carpet_nap" "Leaning carpet fibres that resist motion against them."
        Scale::rising("fraction of speed lost against them at half power", 0.03, 0.1, 0.25),
        Some(Scale::free("direction of greatest drag in degrees", -180.0, -60.0, 180.0));
    table TurnLoss "turn_loss" "A castor that drags in turns."
        Scale::rising("cm lost per radian of turn", 1.0, 4.0, 8.0), None;
    table SonarScale "sonar_scale" "The sensor's timer runs fast or slow."
        Scale::factor("factor on readings", 0.85, 1.08, 1.15, 0.02), None;
    table SonarOffset "sonar_offset" "The sensor's electronics respond late or early."
        Scale::signed("cm", 1.0, 4.0, 8.0), None;
    table SonarYaw "sonar_yaw" "The sensor is misaligned."
        Scale::signed("degrees counter-clockwise", 3.0, 10.0, 20.0), None;
    table SonarPitch "sonar_pitch" "The sensor's mount sags, and its beam meets the floor."
        Scale::falling("cm along the floor from the sensor to where its axis meets it", 30.0, 70.0, 150.0, 50.0), None;
    table SonarBeam "sonar_beam" "The beam is wider or narrower."
        Scale::factor("factor on its angle", 0.3, 2.0, 2.5, 0.3), None;
    table SonarGhost "sonar_ghost" "An echo from something at a constant distance."
        Scale::rising("probability per reading", 0.03, 0.12, 0.3), Some(Scale::free("distance in cm", 12.0, 48.0, 80.0));
    table SonarDropout "sonar_dropout" "The sensor's plug loses contact from time to time."
        Scale::rising("fraction of readings lost", 0.05, 0.2, 0.45), None;
    table SonarLag "sonar_lag" "The sensor delivers its readings late."
        Scale::rising("steps", 0.5, 1.0, 3.0), None;
    table SonarAbsorption "sonar_absorption" "Soft walls."
        Scale::falling("factor on the returned sound", 0.1, 0.35, 1.0, 0.25), None;
    table SonarCrosstalk "sonar_crosstalk" "The pings of another sensor are received."
        Scale::rising("probability per reading", 0.03, 0.12, 0.3), None;
    table SonarMultipath "sonar_multipath" "Walls so smooth that sound reflects specularly to a second wall and back."
        Scale::rising("decibels less lost in specular reflection, and more in scattering", 9.0, 14.0, 18.0), None;
    table SonarNoise "sonar_noise" "The sensor's timer is triggered with jitter."
        Scale::rising("cm", 1.0, 4.0, 10.0), None;
    table TrackerRotation "tracker_rotation" "The camera is rotated against the compass."
        Scale::signed("degrees counter-clockwise", 1.5, 6.0, 12.0), None;
    table TrackerScale "tracker_scale" "The camera hangs at a different height than configured."
        Scale::factor("factor on tracked lengths", 0.88, 1.06, 1.12, 0.02), None;
    table LensDistortion "lens_distortion" "The camera's lens magnifies the edge of the picture differently."
        Scale::signed("fraction per square metre", 0.01, 0.04, 0.07), None;
    table MarkerOffset "marker_offset" "The tracker's marker sits ahead of the centre of the axle; negative: behind it."
        Scale::signed("cm", 1.5, 4.0, 8.0), Some(Scale::free("cm to the left", -8.0, 0.0, 8.0));
    table CompassDisturbance "compass_disturbance" "Iron on the robot."
        Scale::rising("largest error of the heading in degrees", 2.0, 7.0, 15.0),
        Some(Scale::free("direction of the iron in degrees", -180.0, 70.0, 180.0));
    table HeadingLag "heading_lag" "The tracker averages the headings of its last pictures."
        Scale::rising("ms by which they are old in the mean", 40.0, 150.0, 350.0), None;
    table TrackerDelay "tracker_delay" "The tracker's poses arrive late."
        Scale::rising("ms", 40.0, 150.0, 350.0), None;
    other WheelEccentricity "wheel_eccentricity" "The wheels' hubs are off-centre."
        Scale::rising("fraction of the radius", 0.05, 0.12, 0.2), None;
    other Backlash "backlash" "Play in the gears."
        Scale::rising("degrees at the wheel", 8.0, 25.0, 60.0), None;
    other CastorKick "castor_kick" "A castor that pushes the tail sideways while it swivels."
        Scale::rising("newtons", 0.3, 0.8, 1.5), None;
    other BrushAdvance "brush_advance" "Motors with brushes set for one direction: weaker backwards."
        Scale::rising("fraction of speed lost backwards", 0.05, 0.2, 0.4), None;
    other StickyPatch "sticky_patch" "A round patch of rough floor in the middle of the room."
        Scale::rising("fraction of speed lost there at half power", 0.1, 0.25, 0.5), None;
    other CommandQuantisation "command_quantisation" "The motor driver has only a few speeds."
        Scale::rising("command step between two speeds", 8.0, 18.0, 30.0), None;
    other LinkJitter "link_jitter" "Each command has a different random delay."
        Scale::rising("ms at most", 80.0, 200.0, 350.0), None;
    other SoftObstacles "soft_obstacles" "Foam obstacles between the arena's hard walls."
        Scale::rising("decibels lost at an obstacle", 5.0, 12.0, 25.0), None;
    other SonarDrift "sonar_drift" "The sensor's timer drifts as it warms up."
        Scale::signed("fraction per minute", 0.08, 0.25, 0.5), None;
    other SonarOneSided "sonar_one_sided" "The beam is louder on the left; negative: on the right."
        Scale::signed("decibels from the centre to an edge", 8.0, 20.0, 35.0), None;
    other MotionNoise "motion_noise" "Grit on the floor, on which a wheel occasionally skids or jumps."
        Scale::rising("maximum fraction of distance lost or gained", 0.4, 0.6, 0.9), None;
    other PlaceBound "place_bound" "Place-dependent echo loudness: the same at every visit, different in every room."
        Scale::rising("fraction of the random variation", 0.5, 0.95, 1.0), Some(Scale::free("number of the room", 0.0, 1.0, 1e6));
    other Unchanged "unchanged" "No change: a healthy robot."
        Scale::rising("nothing", 0.0, 0.0, 0.0), None;
}

impl Effect {
    /// Iterates over all effects: first those that a diagnosis can name, then those outside its table, the held-out ones last.
    pub fn all() -> impl Iterator<Item = Effect> {
        LISTED.iter().copied().chain(HeldOut::all().map(Effect::HeldOut))
    }

    /// Returns its id on the command line and in a diagnosis.
    pub fn id(self) -> &'static str {
        self.entry().id
    }

    /// Returns its description in one sentence.
    pub fn about(self) -> &'static str {
        self.entry().about
    }

    /// Returns whether it is in the table of effects that a diagnosis can name.
    pub fn in_table(self) -> bool {
        self.entry().in_table
    }

    /// Returns the scale of its strength.
    pub fn strength_range(self) -> Scale {
        self.entry().strength
    }

    /// Returns the scale of its second parameter, if it has one.
    pub fn detail_range(self) -> Option<Scale> {
        self.entry().detail
    }
}

impl fmt::Display for Effect {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.id())
    }
}

impl FromStr for Effect {
    type Err = String;

    fn from_str(id: &str) -> Result<Self, String> {
        Effect::all().find(|effect| effect.id() == id).ok_or_else(|| {
            let known: Vec<&str> = Effect::all().map(Effect::id).collect();
            let suggestion = files::did_you_mean(id, known.iter().copied());
            format!("unknown effect {id:?}; expected one of {}{suggestion}", known.join(", "))
        })
    }
}
