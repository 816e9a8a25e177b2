//! Whether a loop meets the conditions of a construction, which the documentation of the building blocks lists entry by entry.

use super::modular::Frame;
use super::points::Loop;
use super::text::{Arrangement, Construction};

/// A frame with the test for zeros among its entries, as seen in a prime field.
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

/// The maximum number of solutions of a case of block 6, for joints of these kinds with links A and B; or the fault. A link that is not
/// `constant` belongs to the pose or to the given joint, at a random value.
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
    // Between two revolute joints a constant link has its normal form; other links are arbitrary.
    let normal =
        (!constant[0] || kinds[0] || kinds[1] || a.is_normal()) && (!constant[1] || kinds[1] || kinds[2] || b.is_normal());
    if kinds == wanted && holds && normal {
        Ok(most)
    } else {
        Err(format!("`{case}` does not hold for this arm"))
    }
}

/// Cases with reduced accuracy, which Newton's method improves.
fn is_rough(case: &str) -> bool {
    matches!(case, "regional_general" | "regional_slide" | "regional_mid_slide")
}

/// The maximum number of solutions of a construction with this loop, or the violated condition. `refined`: a later step improves the solutions
/// to the last digits.
pub(super) fn most(construction: &Construction, way: &Arrangement, closed: &Loop, refined: bool) -> Result<usize, String> {
    let asked = Asked { way, closed, joints: way.order.len() };
    match construction {
        Construction::SphericalTriple { kinds, case, polished } => asked.spherical_triple(kinds, case, *polished, refined),
        Construction::ThreeParallel { polished } => asked.three_parallel(*polished, refined),
        Construction::ParallelTurns { kinds, case } => asked.parallel_turns(kinds, case),
        Construction::Position { case, polished } => asked.position(case, *polished),
        Construction::ThreePrismatic { turning } => asked.three_prismatic(turning),
        Construction::TwoSlides { slides } => asked.two_slides(slides),
        Construction::ShoulderElbowWrist => asked.shoulder_elbow_wrist(),
        Construction::General => asked.general(),
    }
    .map_err(|what| format!("the class is wrong: {what}"))
}

/// The loop of a construction. Each construction has a method that returns its maximum number of solutions, or the fault.
struct Asked<'a> {
    way: &'a Arrangement,
    closed: &'a Loop,
    joints: usize,
}

impl Asked<'_> {
    fn link(&self, place: usize) -> Link<'_> {
        Link { frame: &self.closed.links[place], one: self.closed.modulus.one }
    }

    /// Whether the axes on both sides of a link intersect in a single point.
    fn crosses(&self, place: usize) -> bool {
        self.link(place).is_normal() && self.link(place).meets() && !self.link(place).is_parallel()
    }

    /// Whether the rotation between the revolute joints at two places is about x.
    fn is_about_x(&self, from: usize, to: usize) -> bool {
        let modulus = &self.closed.modulus;
        let [x, y, z] = self.closed.links[from..to].iter().fold(modulus.identity(), |f, g| modulus.compose(&f, g));
        x[..3] == [modulus.one, 0, 0] && y[0] == 0 && z[0] == 0 && z[1] != 0
    }

    /// The places of the joints of a kind, starting at `from`.
    fn places(&self, from: usize, prismatic: bool) -> Vec<usize> {
        (from..self.joints).filter(|place| self.way.prismatic[*place] == prismatic).collect()
    }

    fn first_three(&self, case: &str, kinds: &[bool]) -> Result<usize, String> {
        if self.joints < 3 || kinds != &self.way.prismatic[..3] {
            return Err("the kinds of the first three joints are not those of the loop".into());
        }
        let constants = [self.way.is_constant(0), self.way.is_constant(1)];
        regional(case, kinds, [&self.closed.links[0], &self.closed.links[1]], self.closed, constants)
    }

    fn spherical_triple(&self, kinds: &[bool], case: &str, polished: bool, refined: bool) -> Result<usize, String> {
        let way = self.way;
        if self.joints != 6 || way.prismatic[3..].contains(&true) || !way.is_constant(3) || !way.is_constant(4) {
            return Err("the last three axes are not joined by constant links".into());
        }
        if !self.crosses(3) || !self.crosses(4) || self.closed.links[4][2][3] != 0 {
            return Err("the last three axes do not meet in a point".into());
        }
        polishes(polished, is_rough(case) && !refined)?;
        Ok(2 * self.first_three(case, kinds)?)
    }

    fn three_parallel(&self, polished: bool, refined: bool) -> Result<usize, String> {
        let way = self.way;
        let flat = |place| {
            let link = self.link(place);
            way.is_constant(place) && link.is_normal() && link.is_parallel() && !link.meets()
        };
        if self.joints != 6 || way.prismatic.contains(&true) || !flat(1) || !flat(2) {
            return Err("there are no three parallel axes".into());
        }
        let related = |place| way.is_constant(place) && (self.link(place).meets() || self.link(place).is_parallel());
        polishes(polished, !(related(4) || related(5) || refined))?;
        Ok(8)
    }

    fn parallel_turns(&self, kinds: &[bool], case: &str) -> Result<usize, String> {
        let (way, modulus) = (self.way, &self.closed.modulus);
        if self.joints != 4 || way.open != 3 || way.prismatic[3] {
            return Err("the fourth joint does not turn before the pose".into());
        }
        let mut between = None;
        for place in 0..4 {
            if !way.prismatic[place] {
                if between.is_some_and(|frame: Frame| !Link { frame: &frame, one: 0 }.is_parallel()) {
                    return Err("not all axes are parallel".into());
                }
                between = Some(modulus.identity());
            }
            between = between.map(|frame| modulus.compose(&frame, &self.closed.links[place]));
        }
        self.first_three(case, kinds)
    }

    fn position(&self, case: &str, polished: bool) -> Result<usize, String> {
        if self.joints != 3 || self.way.open != 2 {
            return Err("the position is not behind the third joint".into());
        }
        polishes(polished, is_rough(case))?;
        self.first_three(case, &self.way.prismatic)
    }

    fn three_prismatic(&self, turning: &[usize]) -> Result<usize, String> {
        let places = self.places(0, false);
        let [r1, r2, r3] = places[..] else { return Err("there are not three joints that turn".into()) };
        if self.joints != 6 || *turning != places || (r1..r3).contains(&self.way.open) {
            return Err("the joints that turn are others, or the pose is between them".into());
        }
        self.all_about_x([r1, r2, r3]).map(|()| 2)
    }

    fn two_slides(&self, slides: &[usize]) -> Result<usize, String> {
        let [r1, r2, r3] = self.places(1, false)[..] else { return Err("there are not four joints that turn".into()) };
        if self.joints != 6 || self.way.prismatic[0] || *slides != self.places(1, true) || (r1..r3).contains(&self.way.open) {
            return Err("the joints that slide are others, the first one does, or the pose is between those that turn".into());
        }
        self.all_about_x([r1, r2, r3]).map(|()| 8)
    }

    fn all_about_x(&self, [r1, r2, r3]: [usize; 3]) -> Result<(), String> {
        if self.is_about_x(r1, r2) && self.is_about_x(r2, r3) {
            Ok(())
        } else {
            Err("the links between the joints that turn are no turns about x".into())
        }
    }

    fn shoulder_elbow_wrist(&self) -> Result<usize, String> {
        let way = self.way;
        let turns = self.joints == 7 && !way.prismatic.contains(&true);
        if !turns || way.backward || way.open != 6 || way.order != [0, 1, 2, 3, 4, 5, 6] {
            return Err("the loop is not that of seven turning joints, from the base on".into());
        }
        let through_one =
            |place: usize| self.crosses(place) && self.crosses(place + 1) && self.closed.links[place + 1][2][3] == 0;
        if (0..6).all(|place| self.link(place).is_normal()) && through_one(0) && through_one(4) {
            Ok(8)
        } else {
            Err("there are not three axes through a point at either end".into())
        }
    }

    fn general(&self) -> Result<usize, String> {
        let p = &self.way.prismatic;
        if p[2] || p[5] || (p[3] && p[4]) || ((p[0] || p[1]) && (p[3] || p[4])) {
            Err("the determinant's joints do not turn".into())
        } else {
            Ok(16)
        }
    }
}

/// Checks that Newton's method is called exactly where needed.
fn polishes(polished: bool, wanted: bool) -> Result<(), String> {
    if polished == wanted {
        Ok(())
    } else {
        Err("Newton's method is called where it should not be, or is not".into())
    }
}
