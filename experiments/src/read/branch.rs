//! `branch`: a branch of the inverse kinematics, followed along the path.

use armgen_codegen::document::reader::Fields;

use super::values::Reader;
use crate::model::{BranchRun, Sampling};

impl Reader<'_> {
    pub(super) fn branch(&mut self, fields: &Fields<'_>, sampling: Option<Sampling>) -> Option<BranchRun> {
        let start = self.start(fields);
        self.choice(fields, "branch", &[("follow", ())])?;
        Some(BranchRun { sampling: sampling?, start: start? })
    }
}
