//! Explanations of the findings of `mindgap check`.

use super::entry::Entry;

/// All findings, in the order in which logs are inspected.
pub const FINDINGS: &[Entry] = &[
    Entry {
        id: "clock_seconds",
        what: "Times are in seconds instead of milliseconds; they are corrected.",
        imitated_by: "a step_ms in robot.toml that is a thousand times too large",
        check: "Compare the last t_ms of a run with its duration by a stopwatch.",
    },
    Entry {
        id: "clock_rate",
        what: "Rows are not about step_ms apart; a minority of such runs is left out.",
        imitated_by: "a wrong step_ms in robot.toml",
        check: "Take the differences of t_ms between neighbouring rows.",
    },
    Entry {
        id: "clock_shifted",
        what: "Commands match the motion of an earlier or later time; a minority of such runs is left out.",
        imitated_by: "a latency of several steps",
        check: "Log a start from rest: command and first motion belong to the same step.",
    },
    Entry {
        id: "run_copied",
        what: "A run is present twice; the copy is left out.",
        imitated_by: "nothing: two runs never agree in every digit",
        check: "Compare the two files.",
    },
    Entry {
        id: "command_fraction",
        what: "Commands are fractions of full power instead of -100 to 100; they are corrected if the motion agrees.",
        imitated_by: "a robot that was driven at less than one per cent of its power",
        check: "Look for the largest command in the logs and compare it with the program.",
    },
    Entry {
        id: "heading_radians",
        what: "Headings are in radians instead of degrees; they are corrected.",
        imitated_by: "a robot that hardly turns",
        check: "Turn the robot once by hand: heading_deg should pass through 360 degrees.",
    },
    Entry {
        id: "length_metres",
        what: "Positions are in metres instead of centimetres; they are corrected.",
        imitated_by: "a robot that hardly moves",
        check: "Put the robot at two marks one metre apart: x_cm and y_cm should differ by 100.",
    },
    Entry {
        id: "length_millimetres",
        what: "Positions are in millimetres instead of centimetres; they are corrected.",
        imitated_by: "a full_speed_cm_s in robot.toml that is ten times too small",
        check: "Put the robot at two marks one metre apart: x_cm and y_cm should differ by 100.",
    },
    Entry {
        id: "full_speed_unit",
        what: "The robot drives about a hundred times faster or ten times slower than robot.toml says.",
        imitated_by: "positions in another unit, if turns are off by the same factor",
        check: "Time a straight metre at command 100 and write the speed in cm/s as full_speed_cm_s.",
    },
    Entry {
        id: "tracker_jump",
        what: "The tracked position jumps farther than the robot can drive; these poses are left out.",
        imitated_by: "a full_speed_cm_s in robot.toml that is far too small",
        check: "Watch the tracker's video at these times for reflections or a hidden marker.",
    },
    Entry {
        id: "tracker_frozen",
        what: "The tracker repeats a pose while the robot drives on; these poses are left out.",
        imitated_by: "a robot that is blocked by an obstacle",
        check: "Watch the tracker's video at these times, and leave the pose empty where the robot is lost.",
    },
    Entry {
        id: "heading_flipped",
        what: "The tracker confuses front and back in some rows; their headings are corrected by 180 degrees.",
        imitated_by: "a robot that drives backwards",
        check: "Make the marker asymmetric, so that its front is unmistakable.",
    },
    Entry {
        id: "heading_jump",
        what: "The heading jumps farther than the robot can turn; these poses are left out.",
        imitated_by: "a track_cm in robot.toml that is far too large",
        check: "Watch the tracker's video at these times for a marker that is partly hidden.",
    },
    Entry {
        id: "counter_wraps",
        what: "A rotation counter starts again after each turn; it is left out.",
        imitated_by: "a robot that never turns its wheels by more than a turn",
        check: "Turn the wheel by hand: the counter should grow beyond 360.",
    },
    Entry {
        id: "counter_jump",
        what: "A rotation counter jumps farther than the wheel can turn; these counts are left out.",
        imitated_by: "a full_speed_cm_s or wheel_diameter_cm in robot.toml that is far too small",
        check: "See whether the program resets its counters while it logs, or whether they overflow.",
    },
    Entry {
        id: "counter_backwards",
        what: "A rotation counter falls while its wheel is commanded forwards; it is left out.",
        imitated_by: "exchanged or reversed motors",
        check: "Turn the wheel forwards by hand: the counter should grow.",
    },
    Entry {
        id: "counter_unit",
        what: "A rotation counter counts far more or less than the commanded rotation; it is left out.",
        imitated_by: "a full_speed_cm_s or wheel_diameter_cm in robot.toml that is far off",
        check: "Turn the wheel once by hand: the counter should grow by 360.",
    },
    Entry {
        id: "gyro_sign",
        what: "The gyro is negative in turns to the left; it is left out.",
        imitated_by: "headings that are counted clockwise, where there are no counters",
        check: "Turn the robot to the left by hand: gyro_deg_s should be positive.",
    },
    Entry {
        id: "gyro_unit",
        what: "The gyro shows far more or less than the turn of the robot, as in radians per second; it is left out.",
        imitated_by: "a robot that hardly turns as commanded, where there are neither poses nor counters",
        check: "Turn the robot once by hand within ten seconds: gyro_deg_s should show about 36.",
    },
    Entry {
        id: "moves_at_zero_command",
        what: "The robot moves long after its commands became zero; these poses are left out.",
        imitated_by: "a steep slope or a push by hand",
        check: "See whether something outside the log drives the robot, such as another program.",
    },
    Entry {
        id: "starts_moving",
        what: "A run begins while the robot moves; these poses are left out.",
        imitated_by: "a tracker that settles during the first rows",
        check: "Start logging before the first command.",
    },
    Entry {
        id: "heading_constant",
        what: "The heading never changes although the commands turn the robot: the track has no rotation, or another axis than z \
               points upwards.",
        imitated_by: "a robot that cannot turn",
        check: "Turn the robot by hand: heading_deg should change.",
    },
    Entry {
        id: "frame_turned",
        what: "The frame of the poses is turned by a quarter or half turn against the motion or the walls.",
        imitated_by: "a sensor that is mounted sideways, if only the walls disagree",
        check: "Push the robot along +x: x_cm should grow and heading_deg should be 0.",
    },
    Entry {
        id: "frame_mirrored",
        what: "The frame of the poses is mirrored against the motion or the walls.",
        imitated_by: "exchanged motors, if the walls do not tell",
        check: "Push the robot to the right on the map: x_cm should grow.",
    },
    Entry {
        id: "y_downwards",
        what: "The y axis points down, as in images.",
        imitated_by: "headings that are counted clockwise",
        check: "Push the robot up on the map: y_cm should grow.",
    },
    Entry {
        id: "xy_exchanged",
        what: "The x and y columns are exchanged.",
        imitated_by: "a mirrored frame",
        check: "Push the robot along +x: only x_cm should change.",
    },
    Entry {
        id: "heading_clockwise",
        what: "Headings are counted clockwise, as by a compass.",
        imitated_by: "a y axis that points down",
        check: "Turn the robot to its left by hand: heading_deg should grow.",
    },
    Entry {
        id: "left_right_exchanged",
        what: "The robot turns right where the commands turn it left.",
        imitated_by: "a mirrored frame with mirrored headings",
        check: "Drive the left motor alone: the robot should turn to its right.",
    },
    Entry {
        id: "commands_reversed",
        what: "The robot drives backwards and turns the other way: both motors have the wrong sign.",
        imitated_by: "a heading that points to the back and is mirrored",
        check: "Give both motors a positive command: the robot should drive forwards.",
    },
    Entry {
        id: "echo_unit",
        what: "Readings are in another unit, or mostly beyond the sensor's range; they are corrected if they then match \
               the walls.",
        imitated_by: "a wrong max_cm in robot.toml, or a scene that is not the room of the logs",
        check: "Put the sensor one metre in front of a wall: echo_cm should be about 100.",
    },
    Entry {
        id: "echo_none_number",
        what: "A number such as 0 or 255 stands for a missing reading; these cells are emptied.",
        imitated_by: "a sonar_ghost at exactly this number",
        check: "Point the sensor into an empty room and see which number it reports.",
    },
    Entry {
        id: "echo_stuck",
        what: "Readings stay exactly equal while the robot moves far; readings are not compared.",
        imitated_by: "a wall that the robot follows at one distance",
        check: "Wave a hand in front of the sensor while it logs.",
    },
    Entry {
        id: "echo_repeated",
        what: "Readings repeat the one before although the robot drove on: old readings are logged again; readings are not \
               compared.",
        imitated_by: "sonar_lag",
        check: "Log a counter of the sensor's readings next to them.",
    },
    Entry {
        id: "echo_saturated",
        what: "Readings pile up at one number, although walls are farther away; readings are not compared.",
        imitated_by: "sonar_crosstalk or sonar_ghost at this number",
        check: "Move a board away from the sensor and note where the reading stops growing.",
    },
    Entry {
        id: "path_outside_arena",
        what: "Poses lie outside the arena of scene.toml; readings are not compared.",
        imitated_by: "a tracker whose origin is not at the arena's corner",
        check: "Measure the arena, and put the robot into its corner at (0, 0).",
    },
    Entry {
        id: "path_through_obstacle",
        what: "The path crosses obstacles of scene.toml; readings are not compared.",
        imitated_by: "a tracker whose frame is shifted",
        check: "Measure the lower-left corner of each obstacle, not its centre.",
    },
    Entry {
        id: "wall_moved",
        what: "Readings of one wall place it elsewhere than scene.toml, while those of others fit; readings are not compared.",
        imitated_by: "a surface of this wall that returns echoes from behind it",
        check: "Measure the distance of this wall from the arena's corner.",
    },
    Entry {
        id: "motion_scale",
        what: "The robot moves and turns by one factor of what is commanded, above 1.6 or below 0.6; it is only reported.",
        imitated_by: "drive_scale",
        check: "Time a straight metre at command 100 by a stopwatch, and compare it with the log.",
    },
];
