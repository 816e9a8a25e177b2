//! "Did you mean ...?": the nearest of the words that are allowed.

/// The one of `words` that `found` was probably meant to be.
pub fn did_you_mean<'w>(found: &str, words: &[&'w str]) -> Option<&'w str> {
    let found: Vec<char> = found.chars().take(64).flat_map(char::to_lowercase).collect();
    // One slip in a short word, two from six letters on, three from nine on; of two letters one must be right, and in front.
    let allowed = (found.len() / 3).max(1);
    let likely = |word: &Vec<char>| {
        let d = distance(&found, word);
        let swapped = || found.iter().rev().eq(word);
        let near = d <= allowed && d < word.len() && (found.len() > 2 || found.first() == word.first() || swapped());
        (d == 0 || near).then_some(d)
    };
    let ranked = words.iter().filter_map(|word| Some((likely(&word.to_lowercase().chars().collect())?, *word)));
    // Of two words as near, the one with the same letters.
    let letters = |word: &str| {
        let mut letters: Vec<char> = word.to_lowercase().chars().collect();
        letters.sort_unstable();
        letters
    };
    let own = letters(&found.iter().collect::<String>());
    ranked.min_by_key(|(d, word)| (*d, letters(word) != own)).map(|(_, word)| word)
}

/// Names of functions in Pinocchio, MuJoCo, the Robotics Toolbox, Drake and books, and their names here.
const OTHER_WORDS: &[(&str, &str)] = &[
    ("M", "inertia_matrix"),
    ("B", "inertia_matrix"),
    ("H", "inertia_matrix"),
    ("D", "inertia_matrix"),
    ("inertia", "inertia_matrix"),
    ("mass_matrix", "inertia_matrix"),
    ("full_mass_matrix", "inertia_matrix"),
    ("crba", "inertia_matrix"),
    ("mj_crb", "inertia_matrix"),
    ("mj_fullM", "inertia_matrix"),
    ("CalcMassMatrix", "inertia_matrix"),
    ("C", "coriolis_matrix"),
    ("coriolis", "coriolis_matrix"),
    ("compute_coriolis_matrix", "coriolis_matrix"),
    ("computeCoriolisMatrix", "coriolis_matrix"),
    ("g", "gravity"),
    ("G", "gravity"),
    ("gravload", "gravity"),
    ("gravity_vector", "gravity"),
    ("compute_generalized_gravity", "gravity"),
    ("computeGeneralizedGravity", "gravity"),
    ("CalcGravityGeneralizedForces", "gravity"),
    ("J", "geometric_jacobian"),
    ("jacobian", "geometric_jacobian"),
    ("jacob0", "geometric_jacobian"),
    ("mj_jac", "geometric_jacobian"),
    ("get_frame_jacobian", "geometric_jacobian"),
    ("getFrameJacobian", "geometric_jacobian"),
    ("computeFrameJacobian", "geometric_jacobian"),
    ("CalcJacobianSpatialVelocity", "geometric_jacobian"),
    ("getFrameJacobianTimeVariation", "geometric_jacobian_dot"),
    ("jacob_dot", "geometric_jacobian_dot"),
    ("fk", "direct_kinematics"),
    ("fkine", "direct_kinematics"),
    ("forward_kinematics", "direct_kinematics"),
    ("forwardKinematics", "direct_kinematics"),
    ("mj_kinematics", "direct_kinematics"),
    ("tau", "inverse_dynamics"),
    ("rne", "inverse_dynamics"),
    ("rnea", "inverse_dynamics"),
    ("mj_rne", "inverse_dynamics"),
    ("mj_inverse", "inverse_dynamics"),
    ("CalcInverseDynamics", "inverse_dynamics"),
    ("nle", "inverse_dynamics"),
    ("nonLinearEffects", "inverse_dynamics"),
    ("computeRNEADerivatives", "inverse_dynamics_derivatives"),
    ("id", "inverse_dynamics"),
    ("aba", "forward_dynamics"),
    ("accel", "forward_dynamics"),
    ("fd", "forward_dynamics"),
    ("mj_forward", "forward_dynamics"),
    ("computeABADerivatives", "forward_dynamics_derivatives"),
    ("ik", "inverse_kinematics"),
    ("ikine", "inverse_kinematics"),
    ("Y", "regressor"),
    ("computeJointTorqueRegressor", "regressor"),
    ("computeKineticEnergy", "kinetic_energy"),
    ("computePotentialEnergy", "potential_energy"),
    ("centerOfMass", "center_of_mass"),
    ("det", "determinant"),
];

/// The one of `words` that other programs and books call `found`; else the one that it was probably meant to be.
pub fn function_meant<'w>(found: &str, words: &[&'w str]) -> Option<&'w str> {
    let plain = found.strip_suffix("_with").unwrap_or(found);
    // Letters stand for other functions as capitals.
    let of_others = OTHER_WORDS
        .iter()
        .find(|(other, _)| *other == plain)
        .or_else(|| OTHER_WORDS.iter().find(|(other, _)| other.len() > 1 && other.eq_ignore_ascii_case(plain)))
        .and_then(|(_, name)| words.iter().copied().find(|word| word == name));
    of_others.or_else(|| did_you_mean(found, words))
}

/// Least number of letters to insert, remove, replace or swap with their neighbour.
fn distance(a: &[char], b: &[char]) -> usize {
    let mut rows: Vec<Vec<usize>> = vec![(0..=b.len()).collect()];
    for i in 1..=a.len() {
        let mut row = vec![i];
        for j in 1..=b.len() {
            let replaced = rows[i - 1][j - 1] + usize::from(a[i - 1] != b[j - 1]);
            let mut best = replaced.min(rows[i - 1][j] + 1).min(row[j - 1] + 1);
            if i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] {
                best = best.min(rows[i - 2][j - 2] + 1);
            }
            row.push(best);
        }
        rows.push(row);
    }
    rows[a.len()][b.len()]
}

#[cfg(test)]
mod tests {
    use super::{did_you_mean, function_meant};

    #[test]
    fn words_of_other_programs_are_known() {
        let words = [
            "direct_kinematics",
            "inverse_dynamics",
            "forward_dynamics",
            "inertia_matrix",
            "coriolis_matrix",
            "gravity",
            "geometric_jacobian",
        ];
        let check = |found: &str, meant: &str| assert_eq!(function_meant(found, &words), Some(meant), "{found}");
        for (found, meant) in [
            ("forward_kinematics", "direct_kinematics"),
            ("fk", "direct_kinematics"),
            ("fkine", "direct_kinematics"),
            ("M", "inertia_matrix"),
            ("B", "inertia_matrix"),
            ("mass_matrix", "inertia_matrix"),
            ("crba", "inertia_matrix"),
            ("inertia", "inertia_matrix"),
            ("C", "coriolis_matrix"),
            ("g", "gravity"),
            ("J", "geometric_jacobian"),
            ("jacob0", "geometric_jacobian"),
            ("jacobian", "geometric_jacobian"),
            ("rnea", "inverse_dynamics"),
            ("aba", "forward_dynamics"),
            ("CalcMassMatrix", "inertia_matrix"),
            ("RNEA", "inverse_dynamics"),
            ("gravty", "gravity"),
        ] {
            check(found, meant);
        }
        assert_eq!(function_meant("xyzzy", &words), None);
    }

    #[track_caller]
    fn check(found: &str, meant: Option<&str>) {
        let words = ["mass", "com", "inertia", "xy", "standard", "modified", "regressor"];
        assert_eq!(did_you_mean(found, &words), meant);
    }

    #[test]
    fn slips_are_recognised_and_other_words_are_not() {
        check("masss", Some("mass"));
        check("Mass", Some("mass"));
        check("yx", Some("xy"));
        assert_eq!(did_you_mean("yx", &["yz", "xy"]), Some("xy"), "the same letters are nearer");
        check("xx", Some("xy"));
        check("ay", None);
        check("intertia", Some("inertia"));
        check("regresor", Some("regressor"));
        check("STANDARD", Some("standard"));
        check("zz", None);
        check("weight", None);
        check("", None);
    }
}
