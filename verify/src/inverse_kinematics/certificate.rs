//! The certificate of a module of inverse kinematics, `robot_ik.cert.json`: the verified facts and texts, and the exact values of the loop's
//! numbers.
//!
//! It follows entirely from the two texts, so a certificate is correct if a new verification gives the same one.

use serde_derive::Serialize;

use super::Report;

#[derive(Serialize)]
struct Certificate<'a> {
    /// Version of this format.
    certificate: u32,
    made_by: String,
    robot: &'a str,
    scalar: &'a str,
    input: Hash<'a>,
    output: Hash<'a>,
    verified: bool,
    faults: &'a [String],
    /// Maximum number of solutions, according to the module.
    most: usize,
    /// The exact values of the loop's numbers, in the order of the text.
    exact_values: &'a [String],
    /// Number of branches that close the loop in prime fields; `None` without a closed form.
    sound_branches: Option<usize>,
    /// Number of solutions at random poses of prime fields, and the loop that counted them.
    generic: Option<Generic<'a>>,
    rational_poses: Poses,
    /// The reason why nothing was counted, if so.
    uncounted: Option<&'a str>,
}

#[derive(Serialize)]
struct Hash<'a> {
    sha256: &'a str,
}

#[derive(Serialize)]
struct Generic<'a> {
    solutions: usize,
    order: &'a [usize],
}

/// Counts of rational poses, by Sturm's theorem.
#[derive(Serialize)]
struct Poses {
    /// The module returns all solutions.
    equal: usize,
    /// Of these, poses without a solution.
    unreachable: usize,
    /// The module reports uncertainty.
    near: usize,
    /// Of these, poses with coincident solutions.
    singular: usize,
    /// Not counted, because a joint may be free.
    undecided: usize,
}

impl Report {
    /// The certificate, as JSON.
    pub fn to_json(&self) -> String {
        let certificate = Certificate {
            certificate: 1,
            made_by: format!("armgen {}", env!("CARGO_PKG_VERSION")),
            robot: &self.robot,
            scalar: self.scalar,
            input: Hash { sha256: &self.input },
            output: Hash { sha256: &self.output },
            verified: self.passed(),
            faults: &self.faults,
            most: self.most,
            exact_values: &self.exact_values,
            sound_branches: self.sound,
            generic: self.generic.as_ref().map(|(solutions, order)| Generic { solutions: *solutions, order }),
            rational_poses: Poses {
                equal: self.equal,
                unreachable: self.unreachable,
                near: self.near,
                singular: self.singular,
                undecided: self.undecided,
            },
            uncounted: self.uncounted.as_deref(),
        };
        serde_json::to_string_pretty(&certificate).expect("a certificate has text keys only") + "\n"
    }
}
