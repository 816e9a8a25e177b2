//! All solutions of inverse kinematics: a construction as plain data, and the calls of its compiled blocks.
//!
//! The blocks of `armgen-inverse-kinematics` run in its order: the loop of the arm at a pose, the construction, the refinement of
//! its solutions, the arm's own order, the verdict. An emitted module makes the same calls with the same constants, so the bits
//! are equal.

use std::fmt;

use crate::scalar::Scalar;

/// A rigid displacement by rows of (R | t).
pub type Frame<T> = [[T; 4]; 3];

/// One way round the loop that an arm and a pose close; as the block `Arrangement`, for any number of joints.
#[derive(Clone, Debug, PartialEq)]
pub struct Arrangement<T> {
    /// The number of each joint in the arm, from 0, in the order in which the loop meets them.
    pub order: Vec<usize>,
    /// Whether they slide, in the loop's order.
    pub prismatic: Vec<bool>,
    /// The link after each joint. The entry at place `open` is not read.
    pub links: Vec<Frame<T>>,
    /// The place of the link that depends on the pose.
    pub open: usize,
    /// This link is `before` X `after`, with X = T⁻¹, or T if the loop is read `backward`.
    pub before: Frame<T>,
    /// See `before`.
    pub after: Frame<T>,
    /// Read against the arm's direction.
    pub backward: bool,
    /// The loop's joint values minus the arm's: (cos theta, sin theta) of the angle, or (d, 0).
    pub offsets: Vec<[T; 2]>,
}

/// A joint whose value is given; as the block `Given`.
#[derive(Clone, Debug, PartialEq)]
pub struct Given<T> {
    /// Its number in the arm, from 0.
    pub joint: usize,
    /// The place in the loop of the link that it moves, if it is between two other joints; else it is at an end of the arm.
    pub place: Option<usize>,
    /// Whether it slides.
    pub prismatic: bool,
    /// From the joint before it, or the base.
    pub before: Frame<T>,
    /// To the joint after it, or the end effector.
    pub after: Frame<T>,
}

/// The redundancy: a value that the caller gives with the pose.
#[derive(Clone, Debug, PartialEq)]
pub enum Redundancy<T> {
    /// The value of a joint, rad or m.
    Joint(Given<T>),
    /// The swivel angle of the elbow, rad.
    Swivel,
}

/// Three joints that bring a point to a point: the block of this name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[allow(missing_docs)]
pub enum Case {
    Elbow,
    Crossing,
    General,
    SlideElbow,
    SlideAcross,
    Slide,
    MidSlideElbow,
    MidSlideAcross,
    MidSlide,
    PlaneThenTurn,
    SlideTurnSlide,
    Slides,
}

impl Case {
    /// The case of a block of `armgen-inverse-kinematics`.
    pub fn of_block(name: &str) -> Option<Case> {
        Some(match name {
            "regional_elbow" => Case::Elbow,
            "regional_crossing" => Case::Crossing,
            "regional_general" => Case::General,
            "regional_slide_elbow" => Case::SlideElbow,
            "regional_slide_across" => Case::SlideAcross,
            "regional_slide" => Case::Slide,
            "regional_mid_slide_elbow" => Case::MidSlideElbow,
            "regional_mid_slide_across" => Case::MidSlideAcross,
            "regional_mid_slide" => Case::MidSlide,
            "regional_plane_then_turn" => Case::PlaneThenTurn,
            "regional_slide_turn_slide" => Case::SlideTurnSlide,
            "regional_slides" => Case::Slides,
            _ => return None,
        })
    }

    /// Whether its solutions have closed forms; others are polished.
    fn is_closed(self) -> bool {
        !matches!(self, Case::General | Case::Slide | Case::MidSlide)
    }
}

/// A construction with the loops that it reads.
#[derive(Clone, Debug, PartialEq)]
pub enum Construction<T> {
    /// Three neighbouring axes meet in one point; six joints.
    SphericalTriple(Arrangement<T>, Case),
    /// Three neighbouring axes are parallel; six joints; whether the solutions are polished.
    ThreeParallel(Arrangement<T>, bool),
    /// All revolute axes are parallel; four joints.
    ParallelTurns(Arrangement<T>, Case),
    /// The position that three joints reach.
    Position(Arrangement<T>, Case),
    /// Three prismatic joints of six; the places of the revolute ones.
    ThreePrismatic(Arrangement<T>, [usize; 3]),
    /// Two prismatic joints of six, by their places.
    TwoSlides(Arrangement<T>, [usize; 2]),
    /// Shoulder and wrist of seven joints.
    ShoulderElbowWrist(Arrangement<T>),
    /// Six joints of no class.
    General(Box<[Arrangement<T>; 2]>),
}

/// Sums of the form `factors` x + `offset`.
#[derive(Clone, Debug, PartialEq)]
pub struct Sums<T> {
    /// A row for each sum, as long as there are sums.
    pub factors: Vec<Vec<T>>,
    /// The constant part of each sum.
    pub offset: Vec<T>,
}

/// The coordinates p of coupled joints with variables q.
#[derive(Clone, Debug, PartialEq)]
pub struct Coordinates<T> {
    /// Whether each joint slides, of those from the base to the end effector. The construction is theirs.
    pub joints: Vec<bool>,
    /// q over p.
    pub variables: Sums<T>,
    /// p over q.
    pub coordinates: Sums<T>,
}

/// Data of an arm from which all its solutions follow.
#[derive(Clone, Debug, PartialEq)]
pub struct InverseKinematics<T> {
    /// Whether each joint of the arm slides; of coupled joints each coordinate.
    pub prismatic: Vec<bool>,
    /// Whether the target includes the orientation. Otherwise it is a position.
    pub orientation: bool,
    /// The construction.
    pub construction: Construction<T>,
    /// The largest number of solutions at a pose with finitely many: 1, 2, 4, 8 or 16.
    pub most: usize,
    /// The names of branches by number; empty without branches.
    pub branches: Vec<String>,
    /// The arm's largest length, m.
    pub length: T,
    /// The redundancy of an arm with one joint more than the target needs.
    pub redundancy: Option<Redundancy<T>>,
    /// The loop of the arm's own joints, if the construction has virtual joints. Their values must be 0 in a solution.
    pub own: Option<Arrangement<T>>,
    /// The coordinates of coupled joints; without them, postures consist of joint variables.
    pub coordinates: Option<Coordinates<T>>,
}

/// Whether the postures at a pose are all that exist.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// These are all.
    Complete,
    /// The pose has no posture, and no pose nearby has any.
    Unreachable,
    /// A change of the pose by its own rounding could change their number.
    NearDouble,
    /// Some joints can move while the end effector stays.
    Continuum,
    /// The pose has an entry that is not finite, or its rotation matrix is no rotation although the target includes it.
    Invalid,
}

/// All postures at a pose, in the order of the emitted module.
#[derive(Clone, Debug, PartialEq)]
pub struct Postures<T> {
    /// Whether these are all.
    pub verdict: Verdict,
    /// Without a posture: the distance by which the construction missed, m; a hint, not a bound. Otherwise how far the rotation of the pose is from
    /// orthonormal, 0 within rounding.
    pub miss: T,
    /// Joint variables of one posture after the other: angles in (-pi, pi], rad; lengths, m.
    pub q: Vec<T>,
    /// The branch number of each posture.
    pub branch: Vec<u16>,
    /// Whether two solutions meet at the posture.
    pub double: Vec<bool>,
    /// Joints of each posture whose values the construction chose, since some joints can move: bit i is joint i + 1.
    pub free: Vec<u32>,
}

impl<T> Postures<T> {
    /// The number of postures.
    pub fn len(&self) -> usize {
        self.branch.len()
    }

    /// Whether the list is empty.
    pub fn is_empty(&self) -> bool {
        self.branch.is_empty()
    }
}

/// The part of the data that does not fit the other parts.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unsound(pub &'static str);

impl fmt::Display for Unsound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} does not fit the construction", self.0)
    }
}

impl std::error::Error for Unsound {}

/// The reason for refusing a call: the arm needs a redundancy, or has no use for it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unfit {
    /// The arm has one joint more than the target needs, and the redundancy is missing.
    Missing,
    /// The arm has no such joint, but a redundancy is given.
    Unasked,
}

impl fmt::Display for Unfit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Unfit::Missing => "the arm has one joint more than the pose asks for: the redundancy is to be given, too",
            Unfit::Unasked => "the arm has no joint more than the pose asks for: a redundancy cannot be given",
        })
    }
}

impl std::error::Error for Unfit {}

/// `f64` or `f32`. The calls for both are compiled in this crate.
pub trait Solved: Scalar {
    /// The construction with the types of its blocks.
    #[doc(hidden)]
    type Table: fmt::Debug + Clone + Send + Sync;
    #[doc(hidden)]
    fn table(of: &InverseKinematics<Self>) -> Result<Self::Table, Unsound>;
    #[doc(hidden)]
    fn solve(table: &Self::Table, pose: &[[Self; 4]; 4], redundancy: Option<Self>) -> Postures<Self>;
    #[doc(hidden)]
    fn swivel(table: &Self::Table, q: &[Self]) -> Option<Self>;
    #[doc(hidden)]
    fn variables(table: &Self::Table, q: &[Self]) -> Vec<Self>;
    #[doc(hidden)]
    fn within(table: &Self::Table, q: &mut [Self], miss: Self, limits: impl Fn(usize) -> [Self; 2]) -> bool;
    #[doc(hidden)]
    fn nearest_of(table: &Self::Table, all: &[Self], q: &[Self]) -> Option<usize>;
}

/// The inverse kinematics of an arm, ready to be called.
#[derive(Clone, Debug)]
pub struct Solver<T: Solved> {
    of: InverseKinematics<T>,
    table: T::Table,
}

impl<T: Solved> Solver<T> {
    /// Errors: parts of the data do not fit each other.
    pub fn new(of: InverseKinematics<T>) -> Result<Self, Unsound> {
        Ok(Solver { table: T::table(&of)?, of })
    }

    /// The data given to [`Solver::new`].
    pub fn of(&self) -> &InverseKinematics<T> {
        &self.of
    }

    /// All postures q with direct_kinematics(q) = T, in the rows of the arm's target.
    ///
    /// - `pose`: T = (R p; 0 1) by rows, of the end effector in the base frame, m. An entry that is not finite gives the verdict
    ///   `Invalid`, as does an R that is no rotation, unless the target is a position. The last row is not used otherwise.
    /// - `redundancy`: the value of [`InverseKinematics::redundancy`], rad or m, for an arm that has it.
    ///
    /// Errors: a missing redundancy, or a redundancy for an arm without it.
    pub fn solve(&self, pose: &[[T; 4]; 4], redundancy: Option<T>) -> Result<Postures<T>, Unfit> {
        match (&self.of.redundancy, redundancy) {
            (Some(_), None) => Err(Unfit::Missing),
            (None, Some(_)) => Err(Unfit::Unasked),
            _ => Ok(T::solve(&self.table, pose, redundancy)),
        }
    }

    /// The redundancy of a posture, with which [`Solver::solve`] finds the posture again.
    ///
    /// Returns `None` for an arm without redundancy, or if the length of `q` differs from the number of joints.
    pub fn redundancy(&self, q: &[T]) -> Option<T> {
        if q.len() != self.of.prismatic.len() {
            return None;
        }
        let q = T::variables(&self.table, q);
        match self.of.redundancy.as_ref()? {
            Redundancy::Joint(given) => q.get(given.joint).copied(),
            Redundancy::Swivel => T::swivel(&self.table, &q),
        }
    }

    /// Those of the arm's postures that are within the limits of its joints, as `within_limits` of an emitted module gives them: angles are moved by whole
    /// turns, and what rounding moved beyond a limit is put at it. The verdict stays as it was.
    ///
    /// - `limits`: of a joint by its number from 0 the lower and the upper end, rad or m; infinite where there is none.
    pub fn within(&self, found: &Postures<T>, limits: impl Fn(usize) -> [T; 2]) -> Postures<T> {
        let mut within = Postures { q: Vec::new(), branch: Vec::new(), double: Vec::new(), free: Vec::new(), ..*found };
        let rest = found.branch.iter().zip(&found.double).zip(&found.free);
        for (q, ((branch, double), free)) in found.q.chunks(self.of.prismatic.len()).zip(rest) {
            let mut q = q.to_vec();
            if T::within(&self.table, &mut q, found.miss, &limits) {
                within.q.append(&mut q);
                within.branch.push(*branch);
                within.double.push(*double);
                within.free.push(*free);
            }
        }
        within
    }

    /// The number of the posture whose largest difference from `q` is smallest, angles modulo whole turns; of equals the first. None if there is none, or
    /// `q` has not as many entries as the arm has joints.
    pub fn nearest(&self, found: &Postures<T>, q: &[T]) -> Option<usize> {
        (q.len() == self.of.prismatic.len()).then(|| T::nearest_of(&self.table, &found.q, q))?
    }
}

/// The calls, in double precision.
mod double;

/// The calls, in single precision.
mod single;
