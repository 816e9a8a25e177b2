//! Whether a construction may be called with a loop: what the documentation of the building blocks asks for, entry by entry.

use super::modular::Frame;
use super::points::Loop;
use super::text::{Arrangement, Construction};

/// Entries of a frame that are 0, as seen in a prime field.
struct Link<'a> {
    frame: &'a Frame,
    one: u64,
}

impl Link<'_> {
    /// Tz(d) Tx(a) Rx(alpha).
    fn is_normal(&self) -> bool {
        let [x, y, z] = self.frame;
        x[..3] == [self.one, 0, 0] && y[0] == 0 && z[0] == 0 && y[3] == 0
    }

    /// a = 0.
    fn meets(&self) -> bool {
        self.frame[0][3] == 0
    }

    fn is_parallel(&self) -> bool {
        self.frame[2][0] == 0 && self.frame[2][1] == 0
    }

    fn is_right(&self) -> bool {
        self.frame[2][2] == 0
    }
}

/// The most solutions of a case of block 6 for joints of these kinds with links A and B, or what is wrong. A link that is not `constant` is that of
/// the pose or of the joint that is given, at a random value.
fn regional(case: &str, kinds: &[bool], [a, b]: [&Frame; 2], closed: &Loop, constant: [bool; 2]) -> Result<usize, String> {
    let link = |frame| Link { frame, one: closed.modulus.one };
    let product = closed.modulus.compose(a, b);
    let determinant = {
        let m = closed.modulus;
        m.minus(m.times(a[0][2], product[1][2]), m.times(a[1][2], product[0][2]))
    };
    let (a, b, both) = (link(a), link(b), link(&product));
    let turning = [false; 3];
    let coaxial = b.is_parallel() && b.meets();
    let (wanted, holds, most) = match case {
        "regional_general" => {
            let (first, second) = (!a.is_parallel() && !a.meets(), !b.is_parallel() && !b.meets());
            (turning, first && (second || !constant[1]), 4)
        }
        "regional_elbow" => (turning, constant[1] && b.is_parallel() && !b.meets() && !a.is_parallel(), 4),
        "regional_crossing" => (turning, constant[0] && a.meets() && !a.is_parallel() && !coaxial, 4),
        "regional_slide_elbow" => ([true, false, false], constant[1] && b.is_parallel() && !b.meets() && !a.is_right(), 2),
        "regional_slide_across" => ([true, false, false], a.is_right() && !coaxial, 4),
        "regional_slide" => ([true, false, false], !b.is_parallel() && !a.is_right(), 4),
        "regional_mid_slide_elbow" => ([false, true, false], both.is_parallel() && !a.is_right(), 2),
        "regional_mid_slide_across" => ([false, true, false], a.is_right(), 4),
        "regional_mid_slide" => ([false, true, false], !a.is_right() && !both.is_parallel(), 4),
        "regional_plane_then_turn" => ([true, true, false], !a.is_parallel(), 2),
        "regional_slide_turn_slide" => ([true, false, true], !(a.is_parallel() && b.is_parallel()), 2),
        "regional_slides" => ([true; 3], determinant != 0, 1),
        other => return Err(format!("there is no construction `{other}`")),
    };
    // Between two turns a constant link is in its normal form; another is whatever it is.
    let normal =
        (!constant[0] || kinds[0] || kinds[1] || a.is_normal()) && (!constant[1] || kinds[1] || kinds[2] || b.is_normal());
    if kinds == wanted && holds && normal {
        Ok(most)
    } else {
        Err(format!("`{case}` does not hold for this arm"))
    }
}

/// Cases that leave digits to Newton's method.
fn is_rough(case: &str) -> bool {
    matches!(case, "regional_general" | "regional_slide" | "regional_mid_slide")
}

/// The most solutions of a construction with this loop, or why it may not be called with it. `refined`: its solutions are brought to the last
/// digits later.
pub(super) fn most(construction: &Construction, way: &Arrangement, closed: &Loop, refined: bool) -> Result<usize, String> {
    let link = |place: usize| Link { frame: &closed.links[place], one: closed.modulus.one };
    let joints = way.order.len();
    let fail = |what: &str| Err(format!("the class is wrong: {what}"));
    // The rotation between the joints that turn at two places is one about x.
    let about_x = |from: usize, to: usize| {
        let product = closed.links[from..to].iter().fold(closed.modulus.identity(), |f, g| closed.modulus.compose(&f, g));
        let [x, y, z] = product;
        x[..3] == [closed.modulus.one, 0, 0] && y[0] == 0 && z[0] == 0 && z[1] != 0
    };
    let of_case = |case: &str, kinds: &[bool]| {
        if joints < 3 || kinds != &way.prismatic[..3] {
            return Err("the kinds of the first three joints are not those of the loop".into());
        }
        let constants = [way.is_constant(0), way.is_constant(1)];
        regional(case, kinds, [&closed.links[0], &closed.links[1]], closed, constants)
            .map_err(|what| format!("the class is wrong: {what}"))
    };
    match construction {
        Construction::SphericalTriple { kinds, case, polished } => {
            if joints != 6 || way.prismatic[3..].contains(&true) || !way.is_constant(3) || !way.is_constant(4) {
                return fail("the last three axes are not joined by constant links");
            }
            let crosses = |place| link(place).is_normal() && link(place).meets() && !link(place).is_parallel();
            if !crosses(3) || !crosses(4) || closed.links[4][2][3] != 0 {
                return fail("the last three axes do not meet in a point");
            }
            if *polished != (is_rough(case) && !refined) {
                return fail("Newton's method is called where it should not be, or is not");
            }
            Ok(2 * of_case(case, kinds)?)
        }
        Construction::ThreeParallel { polished } => {
            let flat =
                |place| way.is_constant(place) && link(place).is_normal() && link(place).is_parallel() && !link(place).meets();
            if joints != 6 || way.prismatic.contains(&true) || !flat(1) || !flat(2) {
                return fail("there are no three parallel axes");
            }
            let related = |place| way.is_constant(place) && (link(place).meets() || link(place).is_parallel());
            if *polished == (related(4) || related(5) || refined) {
                return fail("Newton's method is called where it should not be, or is not");
            }
            Ok(8)
        }
        Construction::ParallelTurns { kinds, case } => {
            if joints != 4 || way.open != 3 || way.prismatic[3] {
                return fail("the fourth joint does not turn before the pose");
            }
            let mut between = None;
            for place in 0..4 {
                if !way.prismatic[place] {
                    if between.is_some_and(|frame: Frame| !Link { frame: &frame, one: 0 }.is_parallel()) {
                        return fail("not all axes are parallel");
                    }
                    between = Some(closed.modulus.identity());
                }
                between = between.map(|frame| closed.modulus.compose(&frame, &closed.links[place]));
            }
            of_case(case, kinds)
        }
        Construction::Position { case, polished } => {
            if joints != 3 || way.open != 2 {
                return fail("the position is not behind the third joint");
            }
            if *polished != is_rough(case) {
                return fail("Newton's method is called where it should not be, or is not");
            }
            of_case(case, &way.prismatic)
        }
        Construction::ThreePrismatic { turning } => {
            let places: Vec<usize> = (0..joints).filter(|place| !way.prismatic[*place]).collect();
            let [r1, r2, r3] = places[..] else { return fail("there are not three joints that turn") };
            if joints != 6 || *turning != places || (r1..r3).contains(&way.open) {
                return fail("the joints that turn are others, or the pose is between them");
            }
            if about_x(r1, r2) && about_x(r2, r3) {
                Ok(2)
            } else {
                fail("the links between the joints that turn are no turns about x")
            }
        }
        Construction::TwoSlides { slides } => {
            let places = |prismatic: bool| (1..joints).filter(|place| way.prismatic[*place] == prismatic).collect::<Vec<_>>();
            let [r1, r2, r3] = places(false)[..] else { return fail("there are not four joints that turn") };
            if joints != 6 || way.prismatic[0] || *slides != places(true) || (r1..r3).contains(&way.open) {
                return fail("the joints that slide are others, the first one does, or the pose is between those that turn");
            }
            if about_x(r1, r2) && about_x(r2, r3) {
                Ok(8)
            } else {
                fail("the links between the joints that turn are no turns about x")
            }
        }
        Construction::ShoulderElbowWrist => {
            let normal = |place: usize| link(place).is_normal();
            let crosses = |place: usize| link(place).meets() && !link(place).is_parallel();
            let through_one = |place: usize| crosses(place) && crosses(place + 1) && closed.links[place + 1][2][3] == 0;
            if joints != 7 || way.prismatic.contains(&true) || way.backward || way.open != 6 || way.order != [0, 1, 2, 3, 4, 5, 6]
            {
                return fail("the loop is not that of seven turning joints, from the base on");
            }
            if (0..6).all(normal) && through_one(0) && through_one(4) {
                Ok(8)
            } else {
                fail("there are not three axes through a point at either end")
            }
        }
        Construction::General => {
            let p = &way.prismatic;
            if p[2] || p[5] || (p[3] && p[4]) || ((p[0] || p[1]) && (p[3] || p[4])) {
                fail("the determinant's joints do not turn")
            } else {
                Ok(16)
            }
        }
    }
}
