//! Figures of experiments, as SVG.
//!
//! ```text
//! svg.rs      lines, texts, clipping: a white page with dark ink
//! plot.rs     panels with axes, ticks, legends; curves thinned to the visible points
//! labels.rs   labels near points, where they hide least
//! arm.rs      postures with ellipsoids, the workspace
//! path.rs     the planned and the traced path, profiles
//! run.rs      errors, torques, estimates over time
//! compare.rs  the members of a group side by side
//! ```
//!
//! This module writes the SVG itself. A plotting library takes a minute to compile and rounds points to whole pixels, which would show
//! a path error of a tenth of a millimetre.

mod arm;
mod compare;
mod labels;
mod path;
mod plot;
mod run;
mod svg;

use std::collections::BTreeMap;

use crate::model::{Body, Experiment, Record, Robot};

pub use run::demonstration;

/// A file to write.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct OutputFile {
    /// Its name, without a folder.
    pub name: String,
    /// Its content.
    pub text: String,
}

/// The figures of an experiment.
pub fn experiment(experiment: &Experiment, record: &Record, robot: &Robot) -> Vec<OutputFile> {
    let Experiment { name, title, body, .. } = experiment;
    let figure = |suffix: &str, text: String| OutputFile { name: format!("{name}{suffix}.svg"), text };
    match body {
        Body::Postures(postures) => {
            let mut figures = vec![figure("_postures", arm::postures(title, postures, &record.shapes))];
            if postures.grid.is_some() {
                figures.push(figure("_workspace", arm::workspace(postures, &record.shapes)));
            }
            figures
        }
        _ if record.log().len() < 2 => Vec::new(),
        Body::Path(sampling) => vec![
            figure("_plan", path::plan(title, &sampling.motion, record, None)),
            figure("_profiles", path::profiles(title, record)),
        ],
        Body::Clik(run) => vec![figure("", run::clik(title, run, record, robot))],
        Body::Branch(_) => vec![figure("", run::branch(title, record, robot))],
        Body::Control(run) => vec![
            figure("", run::control(title, run, record, robot)),
            figure("_trace", path::plan(title, &run.sampling.motion, record, Some("traced"))),
        ],
    }
}

/// The comparisons of all groups that have more than one member.
pub fn groups(all: &[(&Experiment, &Record)], robot: &Robot) -> Vec<OutputFile> {
    let mut groups: BTreeMap<&str, Vec<(&Experiment, &Record)>> = BTreeMap::new();
    for (experiment, record) in all {
        // An experiment may belong to several groups.
        for group in experiment.group.iter().flat_map(|group| group.split_whitespace()) {
            groups.entry(group).or_default().push((experiment, record));
        }
    }
    let compared = groups.iter().filter(|(_, members)| members.len() > 1);
    let figure = |(group, members): (&&str, &Vec<_>)| {
        Some(OutputFile { name: format!("group_{group}.svg"), text: compare::group(group, members, robot)? })
    };
    compared.filter_map(figure).collect()
}
