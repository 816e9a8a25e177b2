//! Figures of experiments, as SVG.
//!
//! ```text
//! svg.rs    lines, texts, clipping: a white page with dark ink
//! plot.rs   panels with axes, ticks, legends; curves thinned to what can be seen
//! arm.rs    postures with ellipsoids, the workspace
//! path.rs   the path as planned and as traced, profiles
//! run.rs    errors, torques, estimates over time; comparisons within a group
//! ```
//!
//! The SVG is written here, not by a plotting library: those looked at place points on whole pixels and know no equal axes, and a
//! path that misses by a tenth of a millimetre shows both.

mod arm;
mod path;
mod plot;
mod run;
mod svg;

use std::collections::BTreeMap;
use std::path::Path;

use crate::experiments::{Body, Experiment, Record};

fn write(out: &Path, name: &str, text: &str) -> Result<usize, String> {
    let file = out.join(format!("{name}.svg"));
    std::fs::write(&file, text).map(|()| 1).map_err(|error| format!("cannot write {}: {error}", file.display()))
}

/// Draws one experiment; the number of figures, or why one could not be written.
pub(crate) fn draw(experiment: &Experiment, record: &Record, out: &Path) -> Result<usize, String> {
    let name = &experiment.name;
    match &experiment.body {
        Body::Postures(postures) => {
            let mut count = write(out, &format!("{name}_postures"), &arm::postures(&experiment.title, postures))?;
            if let Some(text) = arm::workspace(postures) {
                count += write(out, &format!("{name}_workspace"), &text)?;
            }
            Ok(count)
        }
        _ if record.log.len() < 2 => Ok(0),
        Body::Path(sampling) => {
            Ok(write(out, &format!("{name}_plan"), &path::plan(&experiment.title, &sampling.motion, record, None))?
                + write(out, &format!("{name}_profiles"), &path::profiles(&experiment.title, record))?)
        }
        Body::Clik(_) => write(out, name, &run::clik(experiment, record)),
        Body::Control(control) => Ok(write(out, name, &run::control(experiment, control, record))?
            + write(
                out,
                &format!("{name}_trace"),
                &path::plan(&experiment.title, &control.sampling.motion, record, Some("traced")),
            )?),
    }
}

/// Draws the comparisons of all groups.
pub(crate) fn groups(all: &[(&Experiment, &Record)], out: &Path) -> Result<usize, String> {
    let mut groups: BTreeMap<&str, Vec<(&Experiment, &Record)>> = BTreeMap::new();
    for (experiment, record) in all {
        // An experiment may belong to several groups.
        for group in experiment.group.iter().flat_map(|group| group.split_whitespace()) {
            groups.entry(group).or_default().push((experiment, record));
        }
    }
    let mut count = 0;
    for (group, members) in groups.iter().filter(|(_, members)| members.len() > 1) {
        if let Some(text) = run::compare(group, members) {
            count += write(out, &format!("group_{group}"), &text)?;
        }
    }
    Ok(count)
}
