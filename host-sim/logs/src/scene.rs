//! `scene.toml`: walls, obstacles, and the target and start poses of controllers (docs/reference/formats.md).

use std::path::Path;

use glam::DVec2;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use mindgap_files as files;
use mindgap_foundations::error::{Error, Result};
use mindgap_foundations::geometry::{Pose, Rectangle, Wall, bounding_box};

/// The surroundings of a robot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// Upper-right corner of the arena, a rectangle from (0, 0) whose four sides are walls, cm.
    pub arena_cm: Option<DVec2>,
    /// Axis-parallel obstacles.
    pub obstacles: Vec<Rectangle>,
    /// Bare walls.
    pub walls: Vec<Wall>,
    /// Where a controller has to stop, cm.
    pub target_cm: Option<DVec2>,
    /// Start poses of controllers.
    pub starts: Vec<Pose>,
}

impl Scene {
    /// Reads `scene.toml`.
    ///
    /// # Errors
    /// When the file cannot be read or parsed, or contains an impossible size or position.
    pub fn read(path: &Path) -> Result<Self> {
        Scene::parse(path, &files::read_text(path)?)
    }

    /// Parses the text of `scene.toml`; `path` is for messages.
    ///
    /// # Errors
    /// As [`Scene::read`].
    pub fn parse(path: &Path, text: &str) -> Result<Self> {
        let file: SceneFile =
            files::from_toml(path, text).map_err(|error| match text.contains("wheel_diameter_cm") {
                true => Error::in_file(path, "is a robot, not a scene: are --robot and --scene exchanged?"),
                false => error,
            })?;
        let at = |byte: usize, what: &str| Error::at_line(path, files::line_at(text, byte), what);
        let mut scene = Scene::default();
        if let Some(arena) = file.arena {
            let (start, arena) = (arena.span().start, arena.into_inner());
            let size = DVec2::new(arena.width_cm, arena.height_cm);
            if !is_size(size) {
                return Err(at(start, "the arena's width and height must lie between 0 and 100000 cm"));
            }
            scene.arena_cm = Some(size);
        }
        for obstacle in file.obstacle {
            let (start, o) = (obstacle.span().start, obstacle.into_inner());
            let (low_cm, size) = (DVec2::new(o.x_cm, o.y_cm), DVec2::new(o.width_cm, o.height_cm));
            if !is_point(low_cm) || !is_size(size) {
                return Err(at(start, "an obstacle's width and height must lie between 0 and 100000 cm"));
            }
            scene.obstacles.push(Rectangle { low_cm, high_cm: low_cm + size });
        }
        for wall in file.wall {
            let (start, w) = (wall.span().start, wall.into_inner());
            let wall = Wall { from_cm: DVec2::new(w.x0_cm, w.y0_cm), to_cm: DVec2::new(w.x1_cm, w.y1_cm) };
            if !is_point(wall.from_cm) || !is_point(wall.to_cm) || wall.from_cm == wall.to_cm {
                return Err(at(start, "a wall needs two different ends within 100000 cm"));
            }
            scene.walls.push(wall);
        }
        if let Some(target) = file.target {
            let (start, t) = (target.span().start, target.into_inner());
            let target_cm = DVec2::new(t.x_cm, t.y_cm);
            if !is_point(target_cm) || !scene.is_free(target_cm) {
                return Err(at(start, "the target lies outside the arena or inside an obstacle"));
            }
            scene.target_cm = Some(target_cm);
        }
        for s in file.start {
            let (start, s) = (s.span().start, s.into_inner());
            if !is_point(DVec2::new(s.x_cm, s.y_cm)) || !s.heading_deg.is_finite() {
                return Err(at(start, "a start needs finite numbers"));
            }
            if !scene.is_free(DVec2::new(s.x_cm, s.y_cm)) {
                return Err(at(start, "the start lies outside the arena or inside an obstacle"));
            }
            scene.starts.push(Pose::new(s.x_cm, s.y_cm, s.heading_deg.to_radians()));
        }
        Ok(scene)
    }

    /// Writes `scene.toml`.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<()> {
        files::write(path, self.to_text())
    }

    /// Returns the text of `scene.toml`.
    pub fn to_text(&self) -> String {
        let file = SceneFile {
            arena: self.arena_cm.map(|a| without_span(ArenaTable { width_cm: a.x, height_cm: a.y })),
            obstacle: self.obstacles.iter().map(|o| without_span(o.into())).collect(),
            wall: self.walls.iter().map(|w| without_span(w.into())).collect(),
            target: self.target_cm.map(|t| without_span(PointTable { x_cm: t.x, y_cm: t.y })),
            start: self.starts.iter().map(|s| without_span(s.into())).collect(),
        };
        toml::to_string(&file).expect("numbers have a TOML form")
    }

    /// Returns start pose `number` (from 1) for a robot of radius `radius_cm`.
    ///
    /// # Errors
    /// When there is no such start, or the robot would touch something there.
    pub fn start(&self, number: usize, radius_cm: f64) -> Result<Pose> {
        let count = self.starts.len();
        let start = number.checked_sub(1).and_then(|i| self.starts.get(i)).copied();
        let start =
            start.ok_or_else(|| Error::new(format!("has {count} [[start]] table(s); there is no start {number}")))?;
        if !self.has_room_for(start.position_cm, radius_cm) {
            return Err(Error::new(format!("start {number} leaves no room for a robot of radius {radius_cm} cm")));
        }
        Ok(start)
    }

    /// Returns all surfaces: the sides of the arena, the edges of obstacles, bare walls, in this order.
    pub fn sides(&self) -> Vec<Wall> {
        let arena = self.arena_cm.map(|high_cm| Rectangle { low_cm: DVec2::ZERO, high_cm });
        arena.iter().chain(&self.obstacles).flat_map(Rectangle::edges).chain(self.walls.iter().copied()).collect()
    }

    /// Returns the smallest axis-parallel rectangle that contains all surfaces; `None` for an empty scene.
    pub fn bounding_box(&self) -> Option<Rectangle> {
        bounding_box(&self.sides())
    }

    /// Returns whether a point lies inside the arena and outside all obstacles.
    pub fn is_free(&self, point_cm: DVec2) -> bool {
        let inside = self.arena_cm.is_none_or(|high_cm| Rectangle { low_cm: DVec2::ZERO, high_cm }.contains(point_cm));
        inside && !self.obstacles.iter().any(|o| o.contains(point_cm))
    }

    /// Returns whether a disc of radius `radius_cm` around a point touches nothing.
    pub fn has_room_for(&self, point_cm: DVec2, radius_cm: f64) -> bool {
        self.is_free(point_cm) && self.sides().iter().all(|w| w.nearest(point_cm).distance(point_cm) > radius_cm)
    }
}

/// Wraps a table that does not come from a file.
fn without_span<T>(table: T) -> Spanned<T> {
    Spanned::new(0..0, table)
}

fn is_size(v: DVec2) -> bool {
    v.cmpgt(DVec2::ZERO).all() && is_point(v)
}

fn is_point(v: DVec2) -> bool {
    v.is_finite() && v.abs().cmple(DVec2::splat(1e5)).all()
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct SceneFile {
    #[serde(skip_serializing_if = "Option::is_none")]
    arena: Option<Spanned<ArenaTable>>,
    #[serde(default)]
    obstacle: Vec<Spanned<RectangleTable>>,
    #[serde(default)]
    wall: Vec<Spanned<WallTable>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    target: Option<Spanned<PointTable>>,
    #[serde(default)]
    start: Vec<Spanned<StartTable>>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct ArenaTable {
    width_cm: f64,
    height_cm: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct RectangleTable {
    x_cm: f64,
    y_cm: f64,
    width_cm: f64,
    height_cm: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct WallTable {
    x0_cm: f64,
    y0_cm: f64,
    x1_cm: f64,
    y1_cm: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct PointTable {
    x_cm: f64,
    y_cm: f64,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct StartTable {
    x_cm: f64,
    y_cm: f64,
    heading_deg: f64,
}

impl From<&Rectangle> for RectangleTable {
    fn from(r: &Rectangle) -> Self {
        let size = r.high_cm - r.low_cm;
        RectangleTable { x_cm: r.low_cm.x, y_cm: r.low_cm.y, width_cm: size.x, height_cm: size.y }
    }
}

impl From<&Wall> for WallTable {
    fn from(w: &Wall) -> Self {
        WallTable { x0_cm: w.from_cm.x, y0_cm: w.from_cm.y, x1_cm: w.to_cm.x, y1_cm: w.to_cm.y }
    }
}

impl From<&Pose> for StartTable {
    fn from(p: &Pose) -> Self {
        StartTable { x_cm: p.position_cm.x, y_cm: p.position_cm.y, heading_deg: p.heading_rad.to_degrees() }
    }
}
