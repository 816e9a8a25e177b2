//! Values that another library computed: `data/reference`, whose README gives their origin.

use serde_derive::Deserialize;

/// The robots with stored values; each has a description of the same name in `robots/`.
pub const ROBOTS: [&str; 4] = ["scara4", "puma560", "ur5", "panda7"];

/// The values of one robot.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Reference {
    /// Name of the robot.
    pub robot: String,
    /// Random states and what belongs to them.
    pub samples: Vec<Sample>,
}

/// One state of one robot; matrices by rows, SI units.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Sample {
    /// Joint variables.
    pub q: Vec<f64>,
    /// Joint rates.
    #[serde(rename = "qd")]
    pub dq: Vec<f64>,
    /// Joint accelerations.
    #[serde(rename = "qdd")]
    pub ddq: Vec<f64>,
    /// Last link frame in the base frame, 4 x 4.
    #[serde(rename = "T")]
    pub direct_kinematics: Vec<Vec<f64>>,
    /// Geometric Jacobian, 6 x n: linear, then angular.
    #[serde(rename = "J")]
    pub geometric_jacobian: Vec<Vec<f64>>,
    /// B, n x n.
    #[serde(rename = "B")]
    pub inertia_matrix: Vec<Vec<f64>>,
    /// C by Christoffel symbols, n x n.
    #[serde(rename = "C")]
    pub coriolis_matrix: Vec<Vec<f64>>,
    /// g.
    #[serde(rename = "g")]
    pub gravity: Vec<f64>,
    /// B ddq + C dq + g.
    pub tau: Vec<f64>,
    /// Forward dynamics of `tau`: `ddq` up to rounding.
    pub qdd_from_tau: Vec<f64>,
    /// Regressor at (q, dq, dq, ddq), n x 10n, standard parameters link after link.
    #[serde(rename = "Y")]
    pub regressor: Vec<Vec<f64>>,
}

/// The values of one of [`ROBOTS`].
///
/// Panics on another name: the list is ours.
pub fn reference(robot: &str) -> Reference {
    let text = match robot {
        "scara4" => include_str!("../data/reference/scara4.json"),
        "puma560" => include_str!("../data/reference/puma560.json"),
        "ur5" => include_str!("../data/reference/ur5.json"),
        "panda7" => include_str!("../data/reference/panda7.json"),
        _ => panic!("no reference values for `{robot}`"),
    };
    let reference: Reference = serde_json::from_str(text).expect("data/reference is well-formed");
    assert_eq!(reference.robot, robot);
    reference
}

/// Text of a description in `robots/`, by its name without the ending.
///
/// Panics where no robot has this name.
pub fn description(robot: &str) -> String {
    let path = format!("{}/../robots/{robot}.yaml", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("robots/{robot}.yaml: {error}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every robot of `robots/` gives the source of its numbers in its first lines.
    #[test]
    fn sources() {
        let folder = format!("{}/../robots", env!("CARGO_MANIFEST_DIR"));
        for entry in std::fs::read_dir(folder).expect("robots/") {
            let path = entry.expect("an entry").path();
            let text = std::fs::read_to_string(&path).expect("a description");
            let before = if path.extension().is_some_and(|extension| extension == "urdf") { "<robot" } else { "name:" };
            let head = text.split(before).next().unwrap_or_default();
            let named = ["data sheet", "set of", "computed from", "technical project", "Figures: github.com"]
                .iter()
                .any(|source| head.contains(source));
            assert!(named, "{}: no source in {head:?}", path.display());
        }
    }

    #[test]
    fn shapes() {
        for robot in ROBOTS {
            let samples = reference(robot).samples;
            assert_eq!(samples.len(), 8, "{robot}");
            for s in samples {
                let n = s.q.len();
                assert_eq!((s.dq.len(), s.ddq.len(), s.tau.len(), s.gravity.len(), s.qdd_from_tau.len()), (n, n, n, n, n));
                let shape = |m: &[Vec<f64>]| (m.len(), m[0].len());
                assert_eq!(shape(&s.direct_kinematics), (4, 4));
                assert_eq!(shape(&s.geometric_jacobian), (6, n));
                assert_eq!((shape(&s.inertia_matrix), shape(&s.coriolis_matrix)), ((n, n), (n, n)));
                assert_eq!(shape(&s.regressor), (n, 10 * n));
            }
        }
    }
}
