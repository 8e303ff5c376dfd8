//! One expression of an own effect: compiled once, and evaluated wherever the effect acts.

use nanoexpr::{Context, Error, ErrorKind, Instruction, Math, Program};

use super::variables::{Circumstances, Stage, Variable};
use mindgap_files as files;

/// A compiled expression.
pub struct Expression {
    program: Program<'static, 'static, f64>,
    variables: Vec<&'static Variable>,
    parameters: Vec<&'static str>,
}

/// Longer texts are refused: a form that nobody can read is no hypothesis.
const LONGEST: usize = 500;
/// Larger values count as none: metres are hundreds, and no step drives a kilometre.
const LARGEST: f64 = 1e5;
/// A name is followed by this where it is a function's.
const CALL: char = '(';

impl Expression {
    /// Compiles a text for a stage.
    ///
    /// # Errors
    /// What is wrong with it, in one line.
    pub fn compile(text: &str, parameters: &[&'static str], stage: Stage) -> Result<Self, String> {
        let variables = Self::check(text, parameters, stage)?;
        // Only valid expressions are kept for as long as the program runs.
        let text: &'static str = String::from(text).leak();
        let code = vec![Instruction::default(); text.len() + 1].leak();
        let program = nanoexpr::compile(text, code).map_err(|error| message(text, &error))?;
        Ok(Expression { program, variables, parameters: parameters.to_vec() })
    }

    /// Returns the variables of a text that can be compiled for a stage.
    ///
    /// # Errors
    /// If the text is invalid; the error is one line.
    pub fn check(text: &str, parameters: &[&str], stage: Stage) -> Result<Vec<&'static Variable>, String> {
        if text.len() > LONGEST {
            return Err(format!("is longer than {LONGEST} characters"));
        }
        let known: Vec<&str> = Variable::known_in(stage).map(|variable| variable.name).collect();
        let mut variables = Vec::new();
        for name in names(text) {
            match Variable::known_in(stage).find(|variable| variable.name == name) {
                Some(variable) => variables.push(variable),
                None if parameters.contains(&name) || is_constant(name) => (),
                None => {
                    let meant = files::did_you_mean(name, known.iter().copied());
                    return Err(format!("{name} is not known here; known are {}{meant}", known.join(", ")));
                }
            }
        }
        // As many instructions as there are characters are always enough.
        let mut code = vec![Instruction::default(); text.len() + 1];
        let _: Program<f64> = nanoexpr::compile(text, &mut code).map_err(|error| message(text, &error))?;
        know_functions(text)?;
        Ok(variables)
    }

    /// Returns whether a parameter or variable occurs in the text.
    pub fn mentions(text: &str, name: &str) -> bool {
        names(text).any(|mentioned| mentioned == name)
    }

    /// Returns its value; `None` if one of its variables is unknown, or if the value is not a number or is larger than
    /// anything that a step could do.
    pub fn value(&self, parameters: &[f64], at: &Circumstances) -> Option<f64> {
        let value = self.program.evaluate(&(Scope { expression: self, parameters, at }, Math)).ok()?;
        (value.abs() <= LARGEST).then_some(value)
    }
}

struct Scope<'a> {
    expression: &'a Expression,
    parameters: &'a [f64],
    at: &'a Circumstances<'a>,
}

impl Context<f64> for Scope<'_> {
    fn variable(&self, name: &str) -> Option<f64> {
        match self.expression.parameters.iter().position(|parameter| *parameter == name) {
            Some(place) => self.parameters.get(place).copied(),
            None => (self.expression.variables.iter().find(|variable| variable.name == name)?.value)(self.at),
        }
    }
}

/// Whether the language itself gives a name its meaning.
pub fn is_constant(name: &str) -> bool {
    name == "mod" || Context::<f64>::variable(&Math, name).is_some()
}

/// Every word of a text that begins with a letter, and whether it is called.
fn words(text: &str) -> Vec<(&str, bool)> {
    let in_word = |c: char| c.is_alphanumeric() || c == '_';
    let (mut rest, mut words) = (text, Vec::new());
    while let Some(begin) = rest.find(in_word) {
        rest = &rest[begin..];
        let (word, after) = rest.split_at(rest.find(|c| !in_word(c)).unwrap_or(rest.len()));
        if !word.starts_with(|c: char| c.is_ascii_digit()) {
            words.push((word, after.trim_start().starts_with(CALL)));
        }
        rest = after;
    }
    words
}

fn names(text: &str) -> impl Iterator<Item = &str> {
    words(text).into_iter().filter(|(_, called)| !called).map(|(word, _)| word)
}

fn functions(text: &str) -> impl Iterator<Item = &str> {
    words(text).into_iter().filter(|(_, called)| *called).map(|(word, _)| word)
}

/// A function that is not known is found only where it is called, and that may be in a branch that is seldom taken.
fn know_functions(text: &str) -> Result<(), String> {
    match functions(text).find(|name| Context::<f64>::call(&Math, name, &[]).is_none()) {
        Some(name) => Err(format!("{name}() is not a known function: see docs/reference/own-effects.md")),
        None => Ok(()),
    }
}

fn message(text: &str, error: &Error) -> String {
    let part = text.get(error.span.start..error.span.end).unwrap_or_default();
    match error.kind {
        ErrorKind::UnexpectedEnd => "ends where something is missing".into(),
        kind => format!("{kind}: {part}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::StepContext;
    use crate::effects::context::{HISTORY, RunHistory, Surroundings};
    use mindgap_foundations::geometry::Pose;
    use mindgap_logs::Scene;

    fn step() -> StepContext {
        let scene = Scene { arena_cm: Some(glam::DVec2::new(300.0, 220.0)), ..Scene::default() };
        let surroundings = Surroundings::new(&mindgap_built_in_robot::default_robot(), &scene);
        let pose = Pose::new(100.0, 50.0, 0.5);
        StepContext {
            commands: [[60.0, 40.0]; HISTORY],
            ..surroundings.context(&RunHistory::default(), 30_000.0, pose)
        }
    }

    fn value(text: &str) -> Option<f64> {
        let step = step();
        let at = Circumstances::of_row(&step, 0.0);
        Expression::compile(text, &["k"], Stage::Command).expect(text).value(&[2.0], &at)
    }

    fn refusal(text: &str) -> String {
        Expression::compile(text, &["k"], Stage::Command).err().expect(text)
    }

    #[test]
    fn variables_and_parameters_have_their_values() {
        assert_eq!(value("k * (left - right) + x_cm"), Some(140.0));
        assert_eq!(value("elapsed_min"), Some(0.5));
        // 41 cm/s at a command of 100, and a track of 11.5 cm.
        assert!((value("v_cm_s").unwrap() - 20.5).abs() < 1e-12);
        assert!((value("w_rad_s").unwrap() + 0.2 * 41.0 / 11.5).abs() < 1e-12);
    }

    #[test]
    fn arithmetic_is_that_of_mathematics() {
        assert_eq!(value("-k ^ 2"), Some(-4.0));
        assert_eq!(value("2 ^ 3 ^ k"), Some(512.0));
        assert_eq!(value("1 / 2"), Some(0.5));
        assert_eq!(value("left > 50 ? max(k, 3, 1) : 1e-3"), Some(3.0));
        assert_eq!(value("sin(heading_rad)"), Some(libm::sin(0.5)));
    }

    #[test]
    fn values_that_are_not_numbers_are_none() {
        for text in
            ["k / 0", "sqrt(-k)", "exp(1000 * k)", "1e300 * k", "0 / (left - left)", "previous_echo", "9 ^ 9 ^ 9 ^ k"]
        {
            assert_eq!(value(text), None, "{text}");
        }
    }

    #[test]
    fn unreadable_expressions_are_reported() {
        assert!(refusal("k * speed").starts_with("speed is not known here; known are left, right, "));
        assert!(refusal("k * turn_rad").contains("turn_rad is not known here"), "commands come before motion");
        assert!(refusal("k > 5 ? 1 : sine(k)").starts_with("sine() is not a known function"));
        assert_eq!(refusal("k *"), "ends where something is missing");
        assert_eq!(refusal("k * * 2"), "unexpected token: *");
        assert_eq!(refusal(""), "ends where something is missing");
        assert!(refusal(&"(".repeat(100)).contains("too deeply"));
        assert!(refusal(&format!("k{}", " + k".repeat(200))).contains("longer than"));
        assert!(refusal("k × 2").starts_with("unexpected character"));
    }
}
