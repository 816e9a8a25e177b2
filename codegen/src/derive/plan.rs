//! Which way a derivation goes where several are exact, and the search for the cheapest.
//!
//! A derivation asks its [`Plan`] at each fork, by the pass that the fork belongs to and a place (a joint, say); way 0 is the plain one.
//! The search tries the other ways fork by fork, counts the operations of each in a sketch of the pool, and keeps what is cheaper, until
//! no single change helps. It is bounded by counts, never by time, and takes the forks in a fixed order.

use std::collections::BTreeMap;

/// A named step that makes the emitted functions cheaper and leaves their values as they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Pass {
    /// Treat parallel axes in one orientation.
    ParallelAxes,
    /// Measure lengths in one of the arm's lengths.
    UnitOfLength,
    /// Move the origins of joint frames along the joint axes.
    Slides,
    /// Choose where a joint meets the wrench, or the gravity, that it feels.
    Meeting,
    /// Keep the moment that C' needs relative to the link that it is at.
    RelativeMoment,
    /// Hand inertial parameters that a joint does not feel on towards the base.
    Grouping,
    /// Choose how much of each such parameter is handed on.
    Freedoms,
    /// Turn the axes of the last link towards its centre of mass.
    Turn,
    /// Try the closed form beside the recursion.
    ClosedForm,
    /// Ask for the sines and cosines of sums of angles as such.
    AngleSums,
    /// Leave out what cancels in every output.
    Cancellation,
    /// Take common factors out of sums, and share partial sums and products.
    Sharing,
    /// Form a sum from another one that holds much of it.
    Sums,
    /// Compute a node from two others that are there anyway.
    Resubstitution,
}

impl Pass {
    /// All of them.
    pub const ALL: [Pass; 14] = [
        Pass::ParallelAxes,
        Pass::UnitOfLength,
        Pass::Slides,
        Pass::Meeting,
        Pass::RelativeMoment,
        Pass::Grouping,
        Pass::Freedoms,
        Pass::Turn,
        Pass::ClosedForm,
        Pass::AngleSums,
        Pass::Cancellation,
        Pass::Sharing,
        Pass::Sums,
        Pass::Resubstitution,
    ];

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Pass::ParallelAxes => "parallel-axes",
            Pass::UnitOfLength => "unit-of-length",
            Pass::Slides => "slides",
            Pass::Meeting => "meeting",
            Pass::RelativeMoment => "relative-moment",
            Pass::Grouping => "grouping",
            Pass::Freedoms => "freedoms",
            Pass::Turn => "turn",
            Pass::ClosedForm => "closed-form",
            Pass::AngleSums => "angle-sums",
            Pass::Cancellation => "cancellation",
            Pass::Sharing => "sharing",
            Pass::Sums => "sums",
            Pass::Resubstitution => "resubstitution",
        }
    }

    /// The pass of a name.
    pub fn named(name: &str) -> Option<Pass> {
        Pass::ALL.into_iter().find(|pass| pass.name() == name)
    }
}

/// A set of passes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Passes(u32);

impl Passes {
    /// No pass.
    pub const NONE: Passes = Passes(0);

    /// All passes.
    pub fn all() -> Passes {
        Pass::ALL.into_iter().collect()
    }

    /// Whether the set holds a pass.
    pub fn contains(self, pass: Pass) -> bool {
        self.0 >> pass as u32 & 1 == 1
    }

    /// Adds a pass.
    pub fn insert(&mut self, pass: Pass) {
        self.0 |= 1 << pass as u32;
    }
}

impl FromIterator<Pass> for Passes {
    fn from_iter<I: IntoIterator<Item = Pass>>(passes: I) -> Passes {
        Passes(passes.into_iter().fold(0, |set, pass| set | 1 << pass as u32))
    }
}

/// Where a derivation may go several ways; joints and links by index. A search takes the forks of a pass in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// The whole arm.
    Arm,
    /// A joint, or the column that starts there.
    Joint(usize),
    /// A column that leaves the link that its moment is relative to.
    Leaving(usize),
    /// A joint, and which of the parameters that it may hand on.
    Parameter(usize, usize),
    /// The link that a column leaves, and whether it is still in the axes of that link's parent.
    Column(usize, bool),
    /// A joint that feels gravity.
    Gravity(usize),
    /// A body whose columns of the regressor are formed, links before the payload.
    Regressor(usize, Wrench),
}

/// Which of the unit wrenches of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Wrench {
    /// Those with a force.
    Force,
    /// Couples.
    Couple,
}

type Fork = (Pass, Place);

/// The ways taken at the forks of a derivation.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    ways: BTreeMap<Fork, usize>,
    /// How many ways each fork met so far has.
    forks: BTreeMap<Fork, usize>,
    without: Passes,
    /// Where forks with many ways begin to count them.
    start: usize,
    /// In tests: ways drawn by this seed where none is chosen.
    #[cfg(test)]
    scattered: Option<u64>,
}

impl Plan {
    /// A plan that takes any ways.
    #[cfg(test)]
    pub(super) fn scattered(seed: u64) -> Plan {
        Plan { scattered: Some(seed), ..Plan::default() }
    }

    /// The plain way everywhere, now and in a search for passes in `without`.
    pub fn new(without: Passes) -> Plan {
        Plan { without, ..Plan::default() }
    }

    /// Whether a pass may be used.
    pub fn has(&self, pass: Pass) -> bool {
        !self.without.contains(pass)
    }

    /// Takes the plain way at the forks of a pass, besides those that are switched off.
    pub fn keep_off(&mut self, pass: Pass) {
        self.without.insert(pass);
    }

    /// Where forks with many ways begin to count them: a search goes downhill, and finds another valley from another start.
    pub fn start(&self) -> usize {
        if self.has(Pass::Meeting) {
            self.start
        } else {
            0
        }
    }

    /// Which of `ways` to take at a fork.
    pub fn way(&mut self, pass: Pass, place: Place, ways: usize) -> usize {
        if ways < 2 || !self.has(pass) {
            return 0;
        }
        self.forks.insert((pass, place), ways);
        #[cfg(test)]
        if let Some(seed) = self.scattered {
            return crate::ring::field::scramble(
                format!("{pass:?} {place:?}").bytes().fold(seed, |s, b| crate::ring::field::scramble(s ^ u64::from(b))),
            ) as usize
                % ways;
        }
        self.ways.get(&(pass, place)).copied().filter(|&way| way < ways).unwrap_or(0)
    }

    /// The cheapest of the plans that searches from several starts find, each with what effort those before have left.
    pub fn search_from(self, starts: &[usize], mut effort: usize, cost: &mut dyn FnMut(&mut Plan) -> (usize, usize)) -> Plan {
        let found = starts.iter().map(|&start| Plan { start, ..self.clone() }.search(&mut effort, cost));
        found.min_by_key(|(cost, _)| *cost).map_or(self.clone(), |(_, plan)| plan)
    }

    /// The plan that costs least, after its cost. `cost` tells the cost of a plan and the effort of finding out, of which `effort` is there.
    fn search(mut self, effort: &mut usize, cost: &mut dyn FnMut(&mut Plan) -> (usize, usize)) -> (usize, Plan) {
        let (mut best, spent) = cost(&mut self);
        *effort = effort.saturating_sub(spent);
        loop {
            let before = best;
            let forks: Vec<(Fork, usize)> = self.forks.iter().map(|(&fork, &ways)| (fork, ways)).collect();
            for (fork, ways) in forks {
                let current = self.ways.get(&fork).copied().unwrap_or(0);
                for way in (0..ways).filter(|&way| way != current) {
                    if *effort == 0 {
                        return (best, self);
                    }
                    let mut changed = self.clone();
                    changed.ways.insert(fork, way);
                    let (found, spent) = cost(&mut changed);
                    *effort = effort.saturating_sub(spent);
                    if found < best {
                        best = found;
                        self = changed;
                    }
                }
            }
            if best == before {
                return (best, self);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_search_finds_the_cheapest_way_and_keeps_off_what_is_switched_off() {
        let cost = |plan: &mut Plan| {
            let slide = plan.way(Pass::Slides, Place::Joint(3), 4);
            // A fork that only one way leads to.
            let extra = if slide == 2 { plan.way(Pass::Meeting, Place::Joint(0), 3) } else { 0 };
            (20 - [0, 3, 5, 4][slide] - 2 * extra, 1)
        };
        let best = |without, effort| {
            let mut plan = Plan::new(without).search_from(&[0], effort, &mut { cost });
            cost(&mut plan).0
        };
        assert_eq!(best(Passes::NONE, 100), 11);
        assert_eq!(best([Pass::Meeting].into_iter().collect(), 100), 15);
        assert_eq!(best([Pass::Slides].into_iter().collect(), 100), 20);
        assert_eq!(best(Passes::NONE, 3), 15, "the effort is bounded");
    }

    #[test]
    fn names_are_told_apart() {
        for pass in Pass::ALL {
            assert_eq!(Pass::named(pass.name()), Some(pass));
        }
        assert_eq!(Pass::named("no-such-pass"), None);
    }
}
