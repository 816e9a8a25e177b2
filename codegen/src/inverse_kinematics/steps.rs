//! The construction as numbered steps, for people.

use super::chain::Arrangement;
use super::classes::Regional;
use super::{Construction, InverseKinematics, Redundancy, Target};

impl InverseKinematics {
    /// Class, steps and singular postures, as lines of text.
    pub fn text(&self) -> String {
        let target = match self.target {
            Target::Pose => "given T = (R p; 0 1)",
            Target::Planar => "given the position and the turn about the parallel axes, of T = (R p; 0 1)",
            Target::Position => "given the position p",
            Target::Pointing => {
                "given position and z axis of the end effector, of T = (R p; 0 1); axis 6 is that z axis, and q6 is dropped"
            }
        };
        let target = match &self.redundancy {
            None => target.to_owned(),
            Some(Redundancy::Joint(given)) => format!("{target} and q{}", given.joint + 1),
            Some(Redundancy::Swivel) => format!("{target} and psi, the turn of the elbow about the line from shoulder to wrist"),
        };
        let mut text = format!("inverse_kinematics: {}, at most {} solutions\n  {target}\n", self.class, self.most);
        let Steps { steps, singular } = self.steps();
        let last = steps.len();
        for (i, step) in steps.iter().enumerate() {
            text += &format!("  {:width$}  {step}\n", i + 1, width = last.to_string().len());
        }
        if !singular.is_empty() {
            text += &format!("  singular: {}\n", singular.join("; "));
        }
        text
    }

    fn steps(&self) -> Steps {
        let mut all = match &self.construction {
            Construction::SphericalTriple(way, case) => spherical_triple(way, case),
            Construction::ThreeParallel(way, polished) => three_parallel(way, *polished),
            Construction::ParallelTurns(way, case) => parallel_turns(way, case),
            Construction::Position(way, case) => Steps::new([read(way)], []).then(case.steps(way)),
            Construction::ThreePrismatic(way, turning) => three_prismatic(way, *turning),
            Construction::TwoSlides(way, slides) => two_slides(way, *slides),
            Construction::ShoulderElbowWrist(_) => shoulder_elbow_wrist(),
            Construction::General(ways) => general(ways),
        };
        if self.own.is_some() {
            let way = &self.loops()[0];
            let last = way.order.len();
            let own = last - way.still;
            let dropped = if own + 1 == last { format!("q{last} has") } else { format!("q{} to q{last} have", own + 1) };
            all.steps.push(format!("{dropped} to be 0 up to rounding: Gauss and Newton's method on the other joints alone, by all six rows; what does not meet them is dropped"));
            all.singular = vec!["the arm's own Jacobian loses rank".into()];
        }
        if let Some(coordinates) = &self.coordinates {
            all.steps.push(format!("coordinates of the joint variables: {}", coordinates.sums()));
        }
        all
    }
}

/// Steps of a construction, in order, and the places at which it is singular.
struct Steps {
    steps: Vec<String>,
    singular: Vec<String>,
}

impl Steps {
    fn new<const S: usize, const P: usize>(steps: [String; S], singular: [String; P]) -> Steps {
        Steps { steps: steps.into(), singular: singular.into() }
    }

    fn then(mut self, next: Steps) -> Steps {
        self.steps.extend(next.steps);
        self.singular.extend(next.singular);
        self
    }
}

fn spherical_triple(way: &Arrangement, case: &Regional) -> Steps {
    let [_, _, _, d, e, f] = numbers(way);
    let point = format!("the point in which axes {d}, {e} and {f} meet does not feel them: where the pose takes it");
    let wrist = Steps::new(
        [
            format!("q{e} from the cosine between axes {d} and {f}: a cos q{e} = b                wrist: + / -"),
            format!("q{d} and q{f} from the rotation that is left"),
        ],
        [format!("axes {d} and {f} parallel (q{d} and q{f} free together)")],
    );
    Steps::new([read(way), point], []).then(case.steps(way)).then(wrist)
}

fn three_parallel(way: &Arrangement, polished: bool) -> Steps {
    let [a, x, y, z, b, c] = numbers(way);
    let pair =
        format!("across axes {x}, {y} and {z} nothing moves but q{a} and q{b}: two equations linear in their sines and cosines");
    let roots = if polished {
        format!("eliminated to one of degree 2 on the circle of q{a} or q{b}: at most four roots; Newton's method for the last digits")
    } else {
        format!("one of them free of one angle: q{a}, then q{b}, each a cos q + b sin q = d            + / -")
    };
    Steps::new(
        [
            read(way),
            pair,
            roots,
            format!("q{c} from the direction of axes {x}, {y} and {z}"),
            format!("q{y} and q{x}: two links in the plane                    elbow: + / -"),
            format!("q{z} from the turn that is left"),
        ],
        [
            format!("the two q{a} or the two q{b} of step 3 meet"),
            format!("elbow stretched or folded (sin q{y} = 0 in the loop)"),
            format!("axis {c} parallel to axis {x} (q{c} free)"),
        ],
    )
}

fn parallel_turns(way: &Arrangement, case: &Regional) -> Steps {
    let [.., d] = numbers::<4>(way);
    Steps::new([read(way), format!("the origin of joint {d} does not feel it: where the pose takes it")], [])
        .then(case.steps(way))
        .then(Steps::new([format!("q{d} from the turn that is left; none if R is tilted against the axes")], []))
}

fn three_prismatic(way: &Arrangement, turning: [usize; 3]) -> Steps {
    let joints = numbers::<6>(way);
    let [r1, r2, r3] = turning.map(|place| joints[place]);
    Steps::new(
        [
            read(way),
            format!(
                "the rotation does not feel the slides: q{r2} from the cosine between axes {r1} and {r3}        wrist: + / -"
            ),
            format!("q{r1} and q{r3} from the rotation that is left"),
            "the slides from three linear equations".into(),
        ],
        [format!("axes {r1} and {r3} parallel (q{r1} and q{r3} free together)"), "slides in one plane".into()],
    )
}

fn two_slides(way: &Arrangement, slides: [usize; 2]) -> Steps {
    let joints = numbers::<6>(way);
    let [a, b] = slides.map(|place| joints[place]);
    let turning: Vec<usize> = (1..6).filter(|place| !slides.contains(place)).map(|place| joints[place]).collect();
    let (first, [r1, r2, r3]) = (joints[0], [turning[0], turning[1], turning[2]]);
    Steps::new(
        [
            read(way),
            format!("with q{first}, q{r2} from the cosine between axes {r1} and {r3}, with either sign of its sine; q{r1} and q{r3} from the rotation that is left"),
            format!("what is left to slide has to be in the plane of joints {a} and {b}: f(q{first}) = 0, the product of f for both signs of degree 4 on the circle (8 roots), from 12 samples"),
            format!("at each real root q{a} and q{b} from two linear equations"),
            NEWTON.into(),
        ],
        [SOLUTIONS_MEET.into()],
    )
}

fn shoulder_elbow_wrist() -> Steps {
    Steps::new(
        [
            "S, in which axes 1, 2 and 3 meet, and W, in which axes 5, 6 and 7 meet, from the pose",
            "q4 by the distance from S to W: two links in the plane across axis 4        elbow: + / -",
            "the elbow E, the point of axis 4 nearest to axis 3, by psi: the rotation that takes the triangle S E W to its place",
            "q1, q2 and q3 from that rotation        shoulder: + / -",
            "q5, q6 and q7 from the rotation that is left        wrist: + / -",
        ]
        .map(String::from),
        [
            "S, E and W in one line (psi has no meaning)",
            "W straight below S (the reference of psi has its pole there)",
            "axes 1 and 3 parallel (q1 and q3 free together)",
            "axes 5 and 7 parallel (q5 and q7 free together)",
        ]
        .map(String::from),
    )
}

fn general(ways: &[Arrangement; 2]) -> Steps {
    let [a, b, c, d, e, f] = numbers(&ways[0]);
    Steps::new(
        [
            read(&ways[0]),
            format!("14 equations of axis {f} as it is seen from behind link {b} both ways: free of q{f}, bilinear in ({d} {e}) and ({a} {b})"),
            format!("q{a} and q{b} eliminated by linear algebra; M(q{c}), 12 x 12, is left"),
            format!("det M(q{c}), of degree 8 on the circle (16 roots), from 24 samples"),
            format!("at each real root q{d} and q{e} from the kernel of M, q{a} and q{b} by a triangular solve, then q{f}"),
            NEWTON.into(),
            format!("where that is not certain to be complete, the same in the order {}, and both are joined", listed(&ways[1])),
        ],
        [SOLUTIONS_MEET.into()],
    )
}

const NEWTON: &str = "Newton's method on the six equations of the pose";
const SOLUTIONS_MEET: &str = "det J = 0 (solutions meet)";
const DIRECTIONS: &str = "the three directions in which the joints move the point in one plane (solutions meet)";

/// The numbers of the joints in the order of the loop, from 1.
fn numbers<const N: usize>(way: &Arrangement) -> [usize; N] {
    std::array::from_fn(|place| way.number(way.order[place]))
}

fn listed(way: &Arrangement) -> String {
    way.order.iter().map(|joint| way.number(*joint).to_string()).collect::<Vec<_>>().join(" ")
}

fn read(way: &Arrangement) -> String {
    format!("the loop that arm and pose close, read in the order {}", listed(way))
}

impl Regional {
    /// The steps that bring a point to a point, and their singular places.
    fn steps(&self, way: &Arrangement) -> Steps {
        let [a, b, c] = numbers(way);
        let elbow = format!("q{c} and q{b}: two links in the plane                    elbow: + / -");
        let stretched = |a: usize, b: usize| format!("elbow stretched or folded (axis {a}, axis {b} and the point in one plane)");
        // The two roots q of an equation for a component of the point along a direction meet where turning about the axis of q does not change it.
        let along = |axis: usize, other: usize| {
            format!("the point in the plane through axis {axis} that is parallel to axis {other} (the two q{axis} meet)")
        };
        let across = |axis: usize, slide: usize, roots: usize| {
            format!("the point in the plane through axis {axis} normal to the direction of joint {slide} (the two q{roots} meet)")
        };
        match self.function {
            "regional_elbow" => Steps::new(
                [format!("q{a} by the component along axis {b}: a cos q{a} + b sin q{a} = d    shoulder: + / -"), elbow],
                [stretched(b, c), along(a, b)],
            ),
            "regional_crossing" => Steps::new(
                [
                    format!("q{c} by the distance from the point in which axes {a} and {b} meet: a cos q{c} + b sin q{c} = d    + / -"),
                    format!("q{b} by the height along axis {a}: a cos q{b} + b sin q{b} = d    + / -"),
                    format!("q{a} by the direction across axis {a}"),
                ],
                [
                    format!("the point in one plane with axis {c} and the point in which axes {a} and {b} meet (the two q{c} meet)"),
                    format!("the point in the plane of axes {a} and {b} (the two q{b} meet; q{a} or q{b} is free where it is on that axis)"),
                ],
            ),
            "regional_slide_elbow" => {
                Steps::new([elbow, format!("q{a}: the length that is left along joint {a}")], [stretched(b, c)])
            }
            "regional_mid_slide_elbow" => Steps::new(
                [format!("q{b} by the height along axis {a}"), format!("q{c} and q{a}: two links in the plane        elbow: + / -")],
                [stretched(a, c)],
            ),
            "regional_slide_across" => Steps::new(
                [
                    format!("q{c} by the component along axis {b}: a cos q{c} + b sin q{c} = d    + / -"),
                    format!("q{b} by the component across it: a cos q{b} + b sin q{b} = d    + / -"),
                    format!("q{a}: the length that is left along joint {a}"),
                ],
                [along(c, b), across(b, a, b)],
            ),
            "regional_mid_slide_across" => Steps::new(
                [
                    format!("q{c} by the height along axis {a}: a cos q{c} + b sin q{c} = d    + / -"),
                    format!("q{b}: a line that meets a circle about axis {a}    + / -"),
                    format!("q{a} by the direction across axis {a}"),
                ],
                [along(c, a), across(a, b, b)],
            ),
            "regional_plane_then_turn" => Steps::new(
                [format!("q{c} by the component normal to both slides    + / -"), format!("q{a} and q{b} are linear")],
                [format!("the point in the plane through axis {c} that contains the normal of both slides (the two q{c} meet)")],
            ),
            "regional_slide_turn_slide" => Steps::new(
                [format!("q{b}: the slides and what is left in one plane    + / -"), format!("q{a} and q{c} are linear")],
                [DIRECTIONS.into()],
            ),
            "regional_slides" => Steps::new([format!("q{a}, q{b} and q{c} from three linear equations")], []),
            _ => Steps::new(
                [
                    format!("q{a} and q{b} eliminated from the squared length and the height: an equation of degree 2 on the circle of q{c}, at most four roots"),
                    format!("q{b} from two linear equations, q{a} from what is left; Newton's method for the last digits"),
                ],
                [DIRECTIONS.into()],
            ),
        }
    }
}
