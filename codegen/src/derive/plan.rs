//! Which way a derivation goes where several are exact, and the search for the cheapest.
//!
//! A derivation asks its [`Plan`] at each fork, by the pass that the fork belongs to and a place (a joint, say); way 0 is the plain one.
//! The search tries the other ways fork by fork, counts the operations of each in a copy of the pool that holds fingerprints only, and
//! keeps what is cheaper, until no single change helps. It is bounded by counts, never by time, and takes the forks in a fixed order.

use std::collections::{BTreeMap, BTreeSet};

use crate::pass::{Pass, Passes};

/// Where a derivation may go several ways; joints and links by index. A search takes the forks of a pass in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Place {
    /// The whole arm.
    Arm,
    /// A joint, or the column that starts there.
    Joint(usize),
    /// A column that leaves the link that its moment is relative to.
    Leaving(usize),
    /// A joint, and one of the parameters that it may pass on.
    Parameter(usize, usize),
    /// The link that a column leaves, and whether it is still in the joint frame at theta = 0.
    Column(usize, bool),
    /// A joint that feels gravity.
    Gravity(usize),
    /// A body whose columns of the regressor are formed, links before the payload.
    Regressor(usize, UnitWrench),
}

/// Which of the unit wrenches of a body.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum UnitWrench {
    /// Those with a force.
    Force,
    /// Couples.
    Couple,
}

type Fork = (Pass, Place);

/// Where a search starts. It is a descent and ends in a local minimum, so that one that starts elsewhere may end lower.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Start {
    /// Added to the choice at forks with many wrench frames.
    pub wrench_frame: usize,
    /// The way taken for each origin, the last one where there are fewer: 0 where the description has it, 1 and on at feet.
    pub origin: usize,
}

impl Start {
    /// The plain ways.
    pub const PLAIN: Start = Start { wrench_frame: 0, origin: 0 };
}

/// The ways taken at the forks of a derivation.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    ways: BTreeMap<Fork, usize>,
    /// How many ways each fork met so far has.
    forks: BTreeMap<Fork, usize>,
    /// The ways that an exact pool refused.
    refused: BTreeSet<(Fork, usize)>,
    without: Passes,
    start: Start,
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
    pub fn disable(&mut self, pass: Pass) {
        self.without.insert(pass);
    }

    /// Added to the choice at forks with many wrench frames.
    pub fn first_wrench_frame(&self) -> usize {
        if self.has(Pass::WrenchFrame) {
            self.start.wrench_frame
        } else {
            0
        }
    }

    /// The chosen way at a fork with this number of ways.
    fn current(&self, fork: Fork, ways: usize) -> usize {
        let first = if fork.0 == Pass::OriginAlongAxis { self.start.origin.min(ways - 1) } else { 0 };
        let chosen = self.ways.get(&fork).copied().filter(|&way| way < ways).unwrap_or(first);
        if self.refused.contains(&(fork, chosen)) {
            0
        } else {
            chosen
        }
    }

    /// Takes the plain way from now on wherever this one would be chosen: its numbers, known in an exact pool alone, are unsuitable.
    pub fn refuse(&mut self, pass: Pass, place: Place, way: usize) {
        self.refused.insert(((pass, place), way));
    }

    /// How many ways were refused.
    pub fn refusals(&self) -> usize {
        self.refused.len()
    }

    /// Which of `ways` to take at a fork.
    pub fn way(&mut self, pass: Pass, place: Place, ways: usize) -> usize {
        if ways < 2 || !self.has(pass) {
            return 0;
        }
        self.forks.insert((pass, place), ways);
        #[cfg(test)]
        if let Some(seed) = self.scattered {
            return armgen_algebra::scramble::scramble(
                format!("{pass:?} {place:?}").bytes().fold(seed, |s, b| armgen_algebra::scramble::scramble(s ^ u64::from(b))),
            ) as usize
                % ways;
        }
        self.current((pass, place), ways)
    }

    /// The cheapest of the plans that searches from several starts find, which share `effort`.
    pub fn search_from(self, starts: &[Start], mut effort: usize, cost: &mut dyn FnMut(&mut Plan) -> (usize, usize)) -> Plan {
        let found = starts.iter().map(|&start| Plan { start, ..self.clone() }.search(&mut effort, cost));
        found.min_by_key(|(cost, _)| *cost).map_or(self.clone(), |(_, plan)| plan)
    }

    /// The plan that costs least, after its cost. `cost` gives the cost of a plan and the effort spent on it, which is taken from `effort`.
    fn search(mut self, effort: &mut usize, cost: &mut dyn FnMut(&mut Plan) -> (usize, usize)) -> (usize, Plan) {
        let (mut best, spent) = cost(&mut self);
        *effort = effort.saturating_sub(spent);
        loop {
            let before = best;
            let forks: Vec<(Fork, usize)> = self.forks.iter().map(|(&fork, &ways)| (fork, ways)).collect();
            for (fork, ways) in forks {
                let current = self.current(fork, ways);
                for way in (0..ways).filter(|&way| way != current) {
                    if self.refused.contains(&(fork, way)) {
                        continue;
                    }
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
            let slide = plan.way(Pass::OriginAlongAxis, Place::Joint(3), 4);
            // A fork that only one way leads to.
            let extra = if slide == 2 { plan.way(Pass::WrenchFrame, Place::Joint(0), 3) } else { 0 };
            (20 - [0, 3, 5, 4][slide] - 2 * extra, 1)
        };
        let best = |without, effort| {
            let mut plan = Plan::new(without).search_from(&[Start::PLAIN], effort, &mut { cost });
            cost(&mut plan).0
        };
        assert_eq!(best(Passes::NONE, 100), 11);
        assert_eq!(best([Pass::WrenchFrame].into_iter().collect(), 100), 15);
        assert_eq!(best([Pass::OriginAlongAxis].into_iter().collect(), 100), 20);
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
