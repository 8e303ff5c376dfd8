//! `mindgap diagnose`

use std::path::PathBuf;

use clap::Args;

use crate::gap::baseline::Baseline;
use crate::gap::evidence::Evidence;
use crate::gap::{effects, search};
use crate::problem::Result;
use crate::simulator::Simulator;

/// Find the gap between a simulator and logs: where it lies, what causes it, and how far it shrinks.
#[derive(Args)]
pub struct Diagnose {
    /// The simulator file, or the word kinematic.
    sim: PathBuf,
    /// Folder of logs.
    logs: PathBuf,
    /// Also write the diagnosis here.
    #[arg(long)]
    json: Option<PathBuf>,
}

impl Diagnose {
    /// Prints the diagnosis.
    pub fn run(&self) -> Result<()> {
        let simulator = Simulator::read(&self.sim)?;
        let baseline = Baseline::learned(&simulator)?;
        let evidence = Evidence::of(&super::read_logs(&self.logs)?);
        let none = search::Fitted::none(&baseline, &evidence);
        let mut all = search::extend(&none, &effects::all(), &baseline, &evidence);
        all.sort_by(|a, b| b.gain_over(&none).nats.total_cmp(&a.gain_over(&none).nats));
        println!("null m {:.1} s {:.1}", none.terms.motion.iter().sum::<f64>(), none.terms.sonar.iter().sum::<f64>());
        for f in all.iter().take(8) {
            let g = f.gain_over(&none);
            println!("{:20} {:40} {:8.1} z {:5.1} {:?}", f.ids()[0], f.hypothesis.forms[0].name, g.nats, g.z(), f.values);
        }
        Ok(())
    }
}
