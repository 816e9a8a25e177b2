//! The certificate beside a module of inverse kinematics, `robot_ik.cert.json`: what was verified of which texts, and the exact values of the loop's
//! numbers.
//!
//! Everything in it follows from the two texts, so a certificate is right if verifying them again gives the same one.

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
    /// At most so many solutions, as the module says.
    most: usize,
    /// The numbers of the loop, in the order of the text, exactly.
    exact_values: &'a [String],
    /// Branches that close the loop in prime fields; none where the construction is no closed form.
    sound_branches: Option<usize>,
    /// Solutions at random poses of prime fields, and the loop that they were counted with.
    generic: Option<Generic<'a>>,
    rational_poses: Poses,
    /// Why nothing was counted, where that is so.
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

/// Rational poses, counted by Sturm's theorem.
#[derive(Serialize)]
struct Poses {
    /// The module returns as many solutions as there are.
    equal: usize,
    /// Of these, without a solution.
    unreachable: usize,
    /// The module says that it does not know.
    near: usize,
    /// Of these, rightly.
    singular: usize,
    /// Not counted: a joint may be free.
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
