//! `clik`: inverse kinematics along the path.

use armgen_codegen::document::reader::{required, Fields};
use armgen_runtime::clik::Integration;

use super::values::{optionals, Allowed, Reader};
use crate::model::{Algorithm, AlgorithmKind, ClikRun, Sampling};

impl Reader<'_> {
    pub(super) fn clik(&mut self, fields: &Fields<'_>, sampling: Option<Sampling>) -> Option<ClikRun> {
        let start = self.start(fields);
        let rows = if fields.has("task") { self.rows(fields, "task") } else { Some(self.robot.task.clone()) };
        let (at, node) = fields.get("clik")?;
        let all: Vec<&'static str> = AlgorithmKind::ALL.iter().flat_map(|kind| kind.keys()).copied().collect();
        let mut known = vec![required("algorithm", "algorithm: inverse"), required("gains", "gains: [500, 500, ...]")];
        known.extend(optionals(&all));
        let keys = self.mapping(node, "`clik`", at, &known)?;
        let kind = self.choice(&keys, "algorithm", &AlgorithmKind::ALL.map(|kind| (kind.name(), kind)))?.value;
        // The number of rows determines the number of gains.
        let gains = rows.as_ref().and_then(|rows| self.rows_of_numbers(&keys, "gains", rows.len()));
        let others: Vec<&str> = all.into_iter().filter(|name| !kind.keys().contains(name)).collect();
        let what = format!("the algorithm `{}`", kind.name());
        self.out_of_place(&keys, &others, &format!("{what} does not use it"));
        let algorithm = match kind {
            AlgorithmKind::Inverse => Algorithm::Inverse,
            AlgorithmKind::Transpose => Algorithm::Transpose,
            AlgorithmKind::PseudoInverse => {
                let objective = self.rows(&keys, "objective");
                Algorithm::PseudoInverse { k_0: self.number(&keys, "k_0", Allowed::NotNegative).unwrap_or(0.0), objective }
            }
            AlgorithmKind::DampedLeastSquares => {
                self.require(&keys, "damping", &what, "damping: 0.03");
                self.require(&keys, "threshold", &what, "threshold: 0.1");
                let damping = self.number(&keys, "damping", Allowed::Positive);
                let threshold = self.number(&keys, "threshold", Allowed::Positive);
                Algorithm::DampedLeastSquares { damping: damping?, threshold: threshold? }
            }
            AlgorithmKind::SecondOrder => {
                self.require(&keys, "k_d", &what, "k_d: [20, 20, ...]");
                if rows.as_ref().is_some_and(|rows| *rows != self.robot.task) {
                    self.out_of_place(fields, &["task"], "second order follows the task of the robot");
                }
                let words = [("explicit_euler", Integration::ExplicitEuler), ("hold_consistent", Integration::HoldConsistent)];
                let integration = match keys.has("integration") {
                    false => Integration::HoldConsistent,
                    true => self.choice(&keys, "integration", &words)?.value,
                };
                Algorithm::SecondOrder { k_d: self.rows_of_numbers(&keys, "k_d", self.robot.task.len())?, integration }
            }
        };
        Some(ClikRun { sampling: sampling?, start: start?, rows: rows?, algorithm, gains: gains? })
    }
}
