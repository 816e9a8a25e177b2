// Postures of an arm: solutions as joint variables, with a verdict.

/// What is known of all the solutions at a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// These are all solutions, as far as the construction can tell; a change of the pose by its rounding keeps their number.
    Complete,
    /// No solution was found, and none is near.
    Unreachable,
    /// A change of the pose by its own rounding could change the number of solutions; two that have met are listed once, as `double`, and two
    /// that may have met each as `double`.
    NearDouble,
    /// Some joints can move while the end effector stays.
    Continuum,
    /// The pose has an entry that is not finite, or no rotation where that is asked for.
    Invalid,
}

/// One posture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Posture<const JOINTS: usize> {
    /// Joint variables: angles in (-pi, pi], rad; lengths.
    pub q: [Real; JOINTS],
    /// Which of the construction's ways leads here: a bit, or the two of a root's number, for each block in the order of its steps.
    pub branch: u16,
    /// Two solutions meet here.
    pub double: bool,
    /// Bit i: joint i + 1 has one of many values, which the construction chose: some joints can move while the end effector stays. The null space of
    /// the Jacobian says which; one that has to move along with these may be without a bit.
    pub free: u32,
}

/// All postures at a pose, at most `MOST`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Postures<const JOINTS: usize, const MOST: usize> {
    /// What is known of them.
    pub verdict: Verdict,
    /// How many there are.
    pub count: usize,
    /// Where there is none: by how much the construction missed. A hint for people, not a bound. Else by how much the postures miss the pose
    /// at least: how far its rotation is from one, 0 within rounding.
    pub miss: Real,
    /// The postures; zeros from `count` on.
    pub all: [Posture<JOINTS>; MOST],
}

impl<const JOINTS: usize, const MOST: usize> Postures<JOINTS, MOST> {
    /// No postures.
    pub fn none(verdict: Verdict) -> Self {
        let none = Posture { q: [0.0; JOINTS], branch: 0, double: false, free: 0 };
        Postures { verdict, count: 0, miss: 0.0, all: [none; MOST] }
    }

    /// The postures, in order.
    pub fn as_slice(&self) -> &[Posture<JOINTS>] {
        self.all.get(..self.count).unwrap_or(&self.all)
    }

    /// The same postures, of a pose with this rotation.
    pub fn of_rotation(&self, t: &Frame) -> Self {
        let off = off_rotation(t);
        let mut result = *self;
        if self.count > 0 && off > ROUNDING {
            result.miss = off;
        }
        result
    }

    /// The postures within the limits of the joints, by their lower and upper ends, infinite where there is none: angles are moved by whole turns into
    /// them, by no turn if that does, else by as few as possible. `prismatic`: the joints that slide; `length`: the arm's, m.
    /// Rounding of the pose can move a joint variable by the root of the unit roundoff (rad; of a slide times `length`), and a pose that is no
    /// rotation by `SENSITIVITY` times `miss` more: so far beyond a limit it counts as within, and is put at the limit. The verdict stays as it was.
    pub fn within(&self, limits: [[Real; 2]; JOINTS], prismatic: [bool; JOINTS], length: Real) -> Self {
        let mut within = Postures { miss: self.miss, ..Postures::none(self.verdict) };
        // Where two solutions meet the error of a joint is the root of the pose's, elsewhere it is smaller.
        let error = sqrt(UNIT_ROUNDOFF) + SENSITIVITY * self.miss;
        for solution in self.as_slice() {
            let mut moved = *solution;
            let mut inside = true;
            for ((q, [low, high]), slides) in moved.q.iter_mut().zip(limits).zip(prismatic) {
                let slack = if slides { error * length } else { error };
                let (least, most) = (low - slack, high + slack);
                if !slides {
                    *q += WHOLE_TURN * whole_turns_between((least - *q) / WHOLE_TURN, (most - *q) / WHOLE_TURN);
                }
                inside &= least <= *q && *q <= most;
                *q = q.max(low).min(high);
            }
            if let (true, Some(slot)) = (inside, within.all.get_mut(within.count)) {
                *slot = moved;
                within.count += 1;
            }
        }
        within
    }

    /// The posture whose largest difference from `q` is smallest, angles modulo whole turns; the first of equals. None if there is none.
    pub fn nearest(&self, q: &[Real; JOINTS], prismatic: [bool; JOINTS]) -> Option<&Posture<JOINTS>> {
        let mut nearest = None;
        let mut least = Real::INFINITY;
        for solution in self.as_slice() {
            let mut largest: Real = 0.0;
            for ((x, y), slides) in solution.q.iter().zip(q).zip(prismatic) {
                let difference = (x - y).abs();
                let turns = if slides { 0.0 } else { rounded(difference / WHOLE_TURN) };
                largest = largest.max((difference - turns * WHOLE_TURN).abs());
            }
            if largest < least {
                (nearest, least) = (Some(solution), largest);
            }
        }
        nearest
    }
}

/// 2 pi.
const WHOLE_TURN: Real = 2.0 * HALF_TURN;

/// The nearest integer to x >= 0.
fn rounded(x: Real) -> Real {
    floor(x + 0.5)
}

/// The integer of least magnitude in [low, high]; 0 if there is none.
fn whole_turns_between(low: Real, high: Real) -> Real {
    if low > 0.0 {
        let least = -floor(-low);
        if least <= high {
            return least;
        }
    } else if high < 0.0 {
        let least = floor(high);
        if least >= low {
            return least;
        }
    }
    0.0
}

/// Whether all entries are finite.
pub fn all_finite(t: &[[Real; 4]; 4]) -> bool {
    let mut sum = 0.0;
    for row in t {
        for x in row {
            // NaN of an infinity, too.
            sum += x - x;
        }
    }
    sum == 0.0
}

/// Whether all entries of a pose are finite and its rotation is one, to 1e-6.
pub fn is_pose(t: &[[Real; 4]; 4]) -> bool {
    let [x, y, z, _] = *t;
    all_finite(t) && off_rotation(&[x, y, z]) <= NO_ROTATION
}

/// How far the rotation of a pose is from one: two unit vectors at a right angle, and the third is what they make it.
fn off_rotation([x, y, z]: &Frame) -> Real {
    let (u, v) = ([x[0], x[1], x[2]], [y[0], y[1], y[2]]);
    let square = (dot(u, u) - 1.0).abs().max((dot(v, v) - 1.0).abs()).max(dot(u, v).abs());
    let third = cross(u, v);
    square.max((third[0] - z[0]).abs()).max((third[1] - z[1]).abs()).max((third[2] - z[2]).abs())
}

/// How far from orthonormal a rotation may be.
const NO_ROTATION: Real = if UNIT_ROUNDOFF < 1e-10 { 1e-6 } else { ROUNDING };

/// By how much a pose moves joint variables, over its own error: the inverse of the smallest singular value of a regular posture, 1e-3 of the
/// arm's length, times four entries that are off.
const SENSITIVITY: Real = 4096.0;

/// The solutions that a construction has found, as joint variables with their verdict. Joints beyond those of the arm are virtual: they are dropped.
/// `prismatic`: the arm's joints that slide. `by_angle`: in the order of the joint variables, for a construction without branches; else in that of
/// the branches.
#[inline]
pub fn conclude<const J: usize, const N: usize, const JOINTS: usize, const MOST: usize>(
    found: &Branches<J, N>,
    prismatic: [bool; JOINTS],
    by_angle: bool,
) -> Postures<JOINTS, MOST> {
    let mut result = Postures::none(Verdict::Complete);
    // The bits of `free` of the joints that the arm has.
    let own: u32 = (1 << JOINTS) - 1;
    let mut near = found.near;
    let mut continuum = found.continuum;
    // Branch and place of each, in this order. Few: by insertion.
    let mut order = [0; N];
    for (last, branch) in found.found().iter().enumerate() {
        let mut place = last;
        if let Some(slot) = order.get_mut(last) {
            *slot = usize::from(branch.signs) * N + last;
        }
        while place > 0 && place < N && order[place] < order[place - 1] {
            order.swap(place, place - 1);
            place -= 1;
        }
    }
    for number in order.iter().take(found.count) {
        let Some(branch) = found.all.get(number % N) else { continue };
        near |= branch.double;
        let mut q = [0.0; JOINTS];
        for ((q, point), slides) in q.iter_mut().zip(&branch.joints).zip(prismatic) {
            *q = if slides { point[0] } else { angle(*point) };
        }
        let finite = q.iter().fold(0.0, |sum, q| sum + q).is_finite();
        let free = branch.free & own;
        continuum |= finite && free != 0;
        match result.all.get_mut(result.count) {
            Some(slot) if finite => {
                *slot = Posture { q, branch: branch.signs, double: branch.double, free };
                result.count += 1;
            }
            _ => near = true,
        }
    }
    if by_angle {
        // Few: insertion. Only the part that counts, so that the zeros stay behind.
        let before = |x: &Posture<JOINTS>, y: &Posture<JOINTS>| {
            let mut pairs = x.q.iter().zip(&y.q);
            pairs.find(|(x, y)| x != y).is_some_and(|(x, y)| x < y)
        };
        for last in 1..result.count {
            let mut place = last;
            while place > 0 && place < MOST && before(&result.all[place], &result.all[place - 1]) {
                result.all.swap(place, place - 1);
                place -= 1;
            }
        }
    }
    result.verdict = if continuum {
        Verdict::Continuum
    } else if near {
        Verdict::NearDouble
    } else if result.count > 0 {
        Verdict::Complete
    } else {
        Verdict::Unreachable
    };
    if result.verdict == Verdict::Unreachable && found.miss < Real::INFINITY {
        result.miss = found.miss;
    }
    result
}
