//! A model file of any format.

use std::path::{Path, PathBuf};

use super::cause::Query;
use super::edit::Answer;
use super::engine::Engine;
use super::ros_yaml::RosYaml;
use super::webots::Webots;
use super::xml::Xml;
use super::{mjcf, robot_toml, sdf, urdf};
use mindgap_foundations::error::{Error, Result};
use mindgap_logs::Robot;

/// A model file.
#[derive(Clone, Debug)]
pub struct Model {
    /// The file.
    pub path: PathBuf,
    /// Its text.
    pub text: String,
    /// Its format.
    pub format: Format,
}

/// The format of a model file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// URDF.
    Urdf,
    /// SDF.
    Sdf,
    /// MJCF.
    Mjcf,
    /// A world or a PROTO file of Webots.
    Webots,
    /// Parameters of ROS controllers as YAML.
    RosYaml,
    /// robot.toml.
    RobotToml,
}

/// The wheels of a model in the format's unit and those of robot.toml differ by less than this factor.
const SAME_SIZE: f64 = 2.0;

impl Model {
    /// Recognises and checks a model file of a robot.
    ///
    /// # Errors
    /// If the format is not known, if the file is broken, is not whole or has several robots, or if its lengths are in another
    /// unit than the format's.
    pub fn new(path: &Path, text: String, robot: &Robot) -> Result<Self> {
        let model = Model { path: path.into(), format: Format::of(path, &text)?, text };
        let track_m = model.checked_track_m()?;
        if let Some(track_m) = track_m {
            let times = track_m * 100.0 / robot.track_cm;
            if !(1.0 / SAME_SIZE..SAME_SIZE).contains(&times) {
                let what = format!(
                    "its wheels stand {track_m} apart, which the format reads as metres, but robot.toml has track_cm = {}: \
                     correct the unit, or name the right robot",
                    robot.track_cm
                );
                return Err(Error::in_file(path, what));
            }
        }
        Ok(model)
    }

    /// Returns the engine that reads the file, if only one does.
    pub fn engine(&self) -> Option<Engine> {
        match self.format {
            Format::Mjcf => Some(Engine::MuJoCo),
            Format::Webots => Some(Engine::Webots),
            Format::Urdf | Format::Sdf | Format::RosYaml | Format::RobotToml => None,
        }
    }

    /// Returns the changes that write a cause into this file.
    ///
    /// # Errors
    /// In words, if there is no tag for it.
    pub fn changes(&self, query: &Query) -> Answer {
        let query = &Query { engine: query.engine.or(self.engine()), ..*query };
        let xml = || Xml::parse(&self.path, &self.text).map_err(|e| e.to_string());
        match self.format {
            Format::Urdf => urdf::changes(&xml()?, query),
            Format::Sdf => sdf::changes(&xml()?, query),
            Format::Mjcf => mjcf::changes(&xml()?, query),
            Format::Webots => Webots::parse(&self.path, &self.text).map_err(|e| e.to_string())?.changes(query),
            Format::RosYaml => RosYaml::parse(&self.path, &self.text).map_err(|e| e.to_string())?.changes(query),
            Format::RobotToml => robot_toml::changes(&self.text, query),
        }
    }

    /// Returns what an engine adds to the file by itself, one sentence each.
    pub fn notes(&self, engine: Option<Engine>) -> Vec<String> {
        let Ok(xml) = Xml::parse(&self.path, &self.text) else { return Vec::new() };
        let notes = match self.format {
            Format::Urdf => urdf::notes(&xml, engine),
            Format::Sdf => sdf::notes(&xml, engine),
            Format::Mjcf | Format::Webots | Format::RosYaml | Format::RobotToml => Vec::new(),
        };
        notes.into_iter().map(|note| format!("{}: {note}", self.path.display())).collect()
    }

    /// Checks the file and returns the distance between its wheels, if it can be read.
    fn checked_track_m(&self) -> Result<Option<f64>> {
        let (path, text) = (&self.path, &self.text);
        Ok(match self.format {
            Format::Urdf => {
                let xml = Xml::parse(path, text)?;
                urdf::check(path, &xml)?;
                urdf::track_m(&xml)
            }
            Format::Sdf => {
                let xml = Xml::parse(path, text)?;
                sdf::check(path, &xml)?;
                sdf::track_m(&xml)
            }
            Format::Mjcf => {
                let xml = Xml::parse(path, text)?;
                mjcf::check(path, &xml)?;
                mjcf::track_m(&xml)
            }
            Format::Webots => Webots::parse(path, text)?.track_m(),
            Format::RosYaml => RosYaml::parse(path, text)?.track_m(),
            Format::RobotToml => {
                robot_toml::check(path, text)?;
                None
            }
        })
    }
}

impl Format {
    /// Recognises the format by the root of an XML file, by the first line, or by the ending of the name.
    fn of(path: &Path, text: &str) -> Result<Self> {
        let ending = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
        if text.trim_start_matches('\u{feff}').starts_with("#VRML_SIM") {
            return Ok(Format::Webots);
        }
        match ending.as_str() {
            "wbt" | "proto" => Ok(Format::Webots),
            "yaml" | "yml" => Ok(Format::RosYaml),
            "toml" => Ok(Format::RobotToml),
            _ if text.trim_start_matches('\u{feff}').trim_start().starts_with('<') => {
                let xml = Xml::parse(path, text)?;
                let root = xml.tree.root_element();
                match root.tag_name().name() {
                    "robot" => Ok(Format::Urdf),
                    "sdf" => Ok(Format::Sdf),
                    "mujoco" => Ok(Format::Mjcf),
                    other => {
                        let what = format!(
                            "<{other}> is not a model of a robot: URDF, SDF and MJCF begin with robot, sdf, mujoco"
                        );
                        Err(Error::at_line(path, xml.line(root), what))
                    }
                }
            }
            _ => {
                let what = "is not a model file: URDF, SDF, MJCF, a world or PROTO of Webots, YAML of ROS controllers, or robot.toml";
                Err(Error::in_file(path, what))
            }
        }
    }
}
