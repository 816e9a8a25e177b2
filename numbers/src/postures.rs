//! All solutions of inverse kinematics: a construction as plain data, and the calls of its compiled blocks.
//!
//! The blocks are those of `armgen-inverse-kinematics`, in its order: the loop of the arm at a pose, the construction, what brings its solutions to
//! the pose, the arm's own order, the verdict. An emitted module has the same calls with its constants, so the bits are the same.

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
    /// The links behind them; that of place `open` is not read.
    pub links: Vec<Frame<T>>,
    /// The place of the link that depends on the pose.
    pub open: usize,
    /// It is `before` X `after`, where X is T⁻¹, or T if the loop is read `backward`.
    pub before: Frame<T>,
    /// See `before`.
    pub after: Frame<T>,
    /// Read against the arm's direction.
    pub backward: bool,
    /// What the loop's joint values have more than the arm's: (cos theta, sin theta), or (d, 0).
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
    /// To the joint behind it, or the end effector.
    pub after: Frame<T>,
}

/// What is given beside the pose.
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
    /// The case that a block of `armgen-inverse-kinematics` is for.
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

/// How all solutions of an arm are found.
#[derive(Clone, Debug, PartialEq)]
pub struct InverseKinematics<T> {
    /// Whether each joint of the arm slides.
    pub prismatic: Vec<bool>,
    /// Whether the orientation is asked for, or the position alone.
    pub orientation: bool,
    /// The construction.
    pub construction: Construction<T>,
    /// At most so many solutions, where they are finitely many: 1, 2, 4, 8 or 16.
    pub most: usize,
    /// The names of branches by number; empty where there are none.
    pub branches: Vec<String>,
    /// The arm's largest length, m.
    pub length: T,
    /// What is given beside the pose of an arm with one joint more than that asks for.
    pub redundancy: Option<Redundancy<T>>,
    /// The loop of the arm's own joints, if the construction has virtual joints that have to come out 0.
    pub own: Option<Arrangement<T>>,
}

/// What is known of all the postures at a pose.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// These are all.
    Complete,
    /// None was found, and none is near.
    Unreachable,
    /// A change of the pose by its own rounding could change their number.
    NearDouble,
    /// Some joints can move while the end effector stays.
    Continuum,
    /// The pose has an entry that is not finite, or no rotation where that is asked for.
    Invalid,
}

/// All postures at a pose, in the order of the emitted module.
#[derive(Clone, Debug, PartialEq)]
pub struct Postures<T> {
    /// What is known of them.
    pub verdict: Verdict,
    /// Where there is none: by how much the construction missed, m; a hint, not a bound. Otherwise 0.
    pub miss: T,
    /// Joint variables of one posture after the other: angles in (-pi, pi], rad; lengths, m.
    pub q: Vec<T>,
    /// Of each posture the number of its branch.
    pub branch: Vec<u16>,
    /// Of each posture whether two solutions meet there.
    pub double: Vec<bool>,
    /// Of each posture the joints whose values the construction chose, since some joints can move: bit i is joint i + 1.
    pub free: Vec<u32>,
}

impl<T> Postures<T> {
    /// How many there are.
    pub fn len(&self) -> usize {
        self.branch.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.branch.is_empty()
    }
}

/// Why data are no inverse kinematics: which part does not fit the others.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unsound(pub &'static str);

impl fmt::Display for Unsound {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} does not fit the construction", self.0)
    }
}

impl std::error::Error for Unsound {}

/// Why a call is refused: what is given beside the pose is not what the arm asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unfit {
    /// The arm has one joint more than a pose asks for, and nothing is given.
    Missing,
    /// The arm has no joint more, and something is given.
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

/// A scalar for which the calls are compiled in this crate: `f64` and `f32`.
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
    fn within(table: &Self::Table, q: &mut [Self], limits: impl Fn(usize) -> [Self; 2]) -> bool;
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

    /// The data that it was made of.
    pub fn of(&self) -> &InverseKinematics<T> {
        &self.of
    }

    /// All postures q with direct_kinematics(q) = T, as far as the target of the arm asks for T.
    ///
    /// - `pose`: T = (R p; 0 1) by rows, of the end effector in the base frame, m. The last row, and the rotation where the position alone is asked
    ///   for, only have to be finite; else the verdict is `Invalid`.
    /// - `redundancy`: of an arm with one joint more the value of [`InverseKinematics::redundancy`].
    ///
    /// Errors: a redundancy is missing, or given to an arm that has none.
    pub fn solve(&self, pose: &[[T; 4]; 4], redundancy: Option<T>) -> Result<Postures<T>, Unfit> {
        match (&self.of.redundancy, redundancy) {
            (Some(_), None) => Err(Unfit::Missing),
            (None, Some(_)) => Err(Unfit::Unasked),
            _ => Ok(T::solve(&self.table, pose, redundancy)),
        }
    }

    /// The redundancy of a posture, with which [`Solver::solve`] finds it again. None: the arm has none, or `q` has not as many entries as the arm has
    /// joints.
    pub fn redundancy(&self, q: &[T]) -> Option<T> {
        if q.len() != self.of.prismatic.len() {
            return None;
        }
        match self.of.redundancy.as_ref()? {
            Redundancy::Joint(given) => q.get(given.joint).copied(),
            Redundancy::Swivel => T::swivel(&self.table, q),
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
            if T::within(&self.table, &mut q, &limits) {
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
