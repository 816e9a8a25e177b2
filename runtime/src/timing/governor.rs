//! Stops, overrides and resumes on a timed path, within all limits.

use super::law::Law;
use super::model::JointFriction;
use super::segment::{Assumed, Inner, Segment};
use super::timed::Timing;
use super::trial::{Formed, Trial};
use crate::linalg::lit;
use crate::reference::JointReference;
use crate::scalar::seconds;
use crate::trajectory::Progress;
use core::time::Duration;
use nalgebra::RealField;

/// What a [`Governor`] shall do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Command<T> {
    /// Move at this share of the speed ds of the timed motion, from 0 to 1; from rest, too.
    Override(T),
    /// Come to rest on the path as soon as the limits allow.
    Stop,
}

/// What the arm does on the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// It moves.
    Moving,
    /// It rests on the path, and its limits of torque allow that.
    Held,
    /// It shall stop, but no torque within the limits holds it here: it goes on to the next place where it can be held.
    GoingOn,
    /// It is at the end of the path.
    Ended,
}

/// The motion at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Governed<T, const N: usize> {
    /// q, dq, ddq.
    pub reference: JointReference<T, N>,
    /// s, ds, dds.
    pub progress: Progress<T>,
    /// What the arm does.
    pub phase: Phase,
}

/// Leads a timed motion: each command becomes a motion on the same path that keeps the limits of the timing on all of every segment.
///
/// At the start of each segment, and where the command changes and the segment goes on for a period, the rows of the limits give the
/// interval of x = ds² at the segment's end. It is cut by the interval from which the end of the path can be reached. An override takes the
/// value nearest to r² x of the timed motion, a stop the least. So speeds change as fast as torques and accelerations allow, and each later
/// command finds a motion.
#[derive(Clone, Debug)]
pub struct Governor<'a, T, const N: usize> {
    timing: Timing<'a, T, N>,
    /// Of each segment: from an x at its start between these the end can be reached.
    reachable: &'a [[T; 2]],
    command: Command<T>,
    phase: Phase,
    segment: usize,
    /// The fraction of the segment at which the law begins.
    from: T,
    rows: Rows<T>,
    law: Law<T>,
    /// How long the law takes, and the time since it began, s.
    duration: T,
    time: T,
    /// The rows that bounded the last choice.
    first: [Option<usize>; 2],
    /// The place of the last choice among the candidates, of a slower and of a faster one.
    choice: [usize; 2],
}

/// The rows of a segment for one k, and what they assume.
#[derive(Clone, Copy, Debug)]
struct Rows<T> {
    k: T,
    assumed: Assumed<T>,
}

/// From which to which share of the timed motion's x rows hold; the last share has no upper end. Narrow windows have tight chords of
/// friction, wide ones connect them.
const WINDOWS: [[f64; 2]; 4] = [[0.0, 1.0], [0.0, 0.5], [0.3, 1.0], [0.8, 1.0]];
/// Rows that are tried: those of the timed motion, and with three k of each window.
const ROWS: usize = 1 + 3 * WINDOWS.len();

impl<'a, T: RealField + Copy, const N: usize> Governor<'a, T, N> {
    /// At the start of the path, held there until the first command. `storage` needs an element for each segment of the timing; `None` where it is shorter.
    pub fn new(timing: &Timing<'a, T, N>, storage: &'a mut [[T; 2]]) -> Option<Self> {
        let segments = timing.all();
        let reachable = storage.get_mut(..segments.len())?;
        let first = segments.first()?;
        let end = segments.last()?.inner.law.x2;
        let mut next = [end, end];
        for (segment, of) in segments.iter().zip(reachable.iter_mut()).rev() {
            *of = if segment.stop { [T::zero(); 2] } else { backwards(timing, segment, next) };
            next = *of;
        }
        let rest = Law { length: first.length, x0: T::zero(), k: T::zero(), x2: T::zero() };
        let mut governor = Self {
            timing: *timing,
            reachable,
            command: Command::Stop,
            phase: Phase::Held,
            segment: 0,
            from: T::zero(),
            rows: Rows { k: T::zero(), assumed: first.inner.assumed },
            law: rest,
            duration: T::zero(),
            time: T::zero(),
            first: [None; 2],
            choice: [1; 2],
        };
        if first.inner.law.x0 > T::zero() {
            governor.command = Command::Override(T::one());
            governor.plan(first.inner.law.x0, T::zero(), None);
        }
        Some(governor)
    }

    /// The same at rest at `s`, where the arm stopped on this path or on its way back; `None` where s is not on the path, too.
    ///
    /// A way from rest inside a segment is searched, not proved to be there: where there is none, the arm stays held.
    pub fn from_rest(timing: &Timing<'a, T, N>, storage: &'a mut [[T; 2]], s: T) -> Option<Self> {
        let segments = timing.all();
        let index = segments.partition_point(|segment| segment.start <= s).checked_sub(1)?;
        let segment = segments.get(index).filter(|segment| s <= segment.end())?;
        let mut governor = Self::new(timing, storage)?;
        (governor.command, governor.phase) = (Command::Stop, Phase::Held);
        (governor.segment, governor.from) = (index, (s - segment.start) / segment.length);
        // Within rounding of its end the next segment begins.
        if governor.from > lit(1.0 - 1e-6) {
            (governor.segment, governor.from) = (index + 1, T::zero());
            if governor.segment >= segments.len() {
                governor.phase = Phase::Ended;
            }
        }
        Some(governor)
    }

    /// The motion a time `period` later, under a command.
    pub fn advance(&mut self, period: Duration, command: Command<T>) -> Governed<T, N> {
        let mut left = seconds::<T>(period);
        if command != self.command {
            self.command = command;
            self.change(left);
        }
        // Each round but the last one leaves a segment.
        for _ in 0..=self.timing.segments() {
            if matches!(self.phase, Phase::Held | Phase::Ended) {
                break;
            }
            if self.time + left < self.duration {
                self.time += left;
                break;
            }
            left -= self.duration - self.time;
            self.leave();
        }
        self.sample()
    }

    /// The motion now.
    pub fn sample(&self) -> Governed<T, N> {
        let progress = self.progress();
        Governed { reference: self.timing.reference(&progress), progress, phase: self.phase }
    }

    /// From which to which x = ds² at the start of a segment the end of the path can be reached; `None` where there are not as many segments.
    /// A stop is possible at the start of the segment if the lower end is 0.
    pub fn reachable(&self, segment: usize) -> Option<[T; 2]> {
        self.reachable.get(segment).copied()
    }

    fn progress(&self) -> Progress<T> {
        let all = self.timing.all();
        let zero = T::zero();
        let Some(segment) = all.get(self.segment) else {
            let last = all.last();
            return Progress {
                s: last.map_or(zero, Segment::end),
                ds: last.map_or(zero, |of| of.inner.law.x2.max(zero).sqrt()),
                dds: zero,
            };
        };
        let start = segment.start + segment.length * self.from;
        if self.phase == Phase::Held {
            return Progress { s: start, ds: zero, dds: zero };
        }
        let (s, ds, dds) = self.law.at(self.time);
        Progress { s: start + s, ds, dds }
    }

    /// A new command: the rest of the segment is a segment. One that ends before the next sample, `period` later, is left as it is, so that
    /// a sample chooses once where others do.
    fn change(&mut self, period: T) {
        let (zero, one) = (T::zero(), T::one());
        match self.phase {
            Phase::Held if self.wants_to_move() => {
                self.plan(zero, self.from, None);
            }
            Phase::Held | Phase::Ended => {}
            Phase::Moving | Phase::GoingOn if self.time + period >= self.duration => {}
            Phase::Moving | Phase::GoingOn => {
                let (s, ..) = self.law.at(self.time);
                let t = s / self.law.length;
                let rest = one - t;
                if rest > lit(1e-6) {
                    // The motion until now stays possible: its rows hold on every part of the segment.
                    let rows = Rows { k: self.rows.k * rest * rest, assumed: self.rows.assumed };
                    self.plan(self.law.x(t).max(zero), self.from + (one - self.from) * t, Some(rows));
                }
            }
        }
    }

    fn wants_to_move(&self) -> bool {
        matches!(self.command, Command::Override(r) if r > T::zero())
    }

    /// Goes on to the next segment, or rests.
    fn leave(&mut self) {
        let (zero, x) = (T::zero(), self.law.x2.max(T::zero()));
        self.segment += 1;
        self.from = zero;
        self.time = zero;
        if self.segment >= self.timing.segments() {
            self.phase = Phase::Ended;
        } else if x == zero && !self.wants_to_move() && self.can_rest(self.segment) {
            self.phase = Phase::Held;
        } else if !self.plan(x, zero, None) {
            // By construction some rows have a motion. Should rounding leave none, the speed stays as near as possible.
            let Some(segment) = self.timing.all().get(self.segment) else { return };
            let [low, high] = self.next(self.segment);
            self.law = Law { length: segment.length, x0: x, k: zero, x2: x.max(low).min(high) };
            self.duration = self.law.duration();
        }
    }

    /// Whether the arm can be held at the start of a segment. From rest before the last one it could only go to rest at its end.
    fn can_rest(&self, segment: usize) -> bool {
        let Timing { limits, friction, .. } = &self.timing;
        let of = self.timing.all().get(segment).filter(|_| segment + 1 < self.timing.segments());
        of.is_some_and(|of| of.unheld(false, limits, friction).is_none())
    }

    /// From these x at the end of a segment the end of the path can be reached.
    fn next(&self, segment: usize) -> [T; 2] {
        let end = self.timing.all().last().map_or(T::zero(), |last| last.inner.law.x2);
        self.reachable.get(segment + 1).copied().unwrap_or([end, end])
    }

    /// Chooses the law from an x at the fraction `from` of the segment to its end; whether there is one.
    fn plan(&mut self, x: T, from: T, current: Option<Rows<T>>) -> bool {
        let (zero, one) = (T::zero(), T::one());
        let Some(whole) = self.timing.all().get(self.segment) else { return false };
        let timed = whole.inner.law;
        let can_stop = x > zero && (self.segment + 1 == self.timing.segments() || self.can_rest(self.segment + 1));
        let (target, phase) = match self.command {
            Command::Override(r) if r > zero => (timed.x2 * r.min(one) * r.min(one), Phase::Moving),
            _ if can_stop => (zero, Phase::Moving),
            // On at half the speed, without getting faster.
            _ => ((timed.x2 * lit(0.25)).min(if x > zero { x } else { timed.x2 }), Phase::GoingOn),
        };
        let own = Rows { k: timed.k, assumed: whole.inner.assumed };
        if from == zero && x == timed.x0 && target == timed.x2 && timed.is_passed() {
            // On the timed motion, which is proved.
            self.go(from, timed, own, phase);
            return true;
        }
        let (width, here) = (one - from, timed.x(from));
        let rest;
        let part = if from > zero {
            rest = whole.part(from);
            &rest
        } else {
            whole
        };
        let scale = match (here > zero, timed.x2 > zero) {
            (true, _) => (x / here).min(one),
            (false, true) => target / timed.x2,
            (false, false) => one,
        };
        let others = Candidates::new(&self.timing, whole);
        let candidate = |index: usize| match index.checked_sub(1) {
            Some(index) => others.rows(index, Some(scale)).map(|rows| Rows { k: rows.k * width * width, ..rows }),
            None => current,
        };
        let (limits, friction, next) = (&self.timing.limits, &self.timing.friction, self.next(self.segment));
        let mut formed = Formed::new();
        let mut trial = Trial::new(part, limits, friction, part.inner.assumed, x, self.first, &mut formed);
        let off = |x2: T| (x2 - target).abs();
        let mut best: Option<(T, usize, Law<T>, Rows<T>)> = None;
        // Those of the last choice first: the trials of others that come no nearer end early.
        let end = usize::from(target > x);
        let last = self.choice.get(end).copied().unwrap_or(0);
        for index in core::iter::once(last).chain((0..=ROWS).filter(|index| *index != last)) {
            let Some(rows) = candidate(index) else { continue };
            let is_nearer = |x2: T| best.as_ref().is_none_or(|(least, at, ..)| (off(x2), index) < (*least, *at));
            let Some(x2) = trial.nearest(rows.k, &rows.assumed, next, target, is_nearer) else { continue };
            let mut law = Law { length: part.length, x0: x, k: rows.k, x2 };
            if !law.is_passed() {
                // A law that rests on its way gives way to the largest X2.
                let largest = trial.nearest(rows.k, &rows.assumed, next, lit(1e30), |_| true);
                law.x2 = largest.unwrap_or(x2);
            }
            if law.is_passed() && is_nearer(law.x2) {
                best = Some((off(law.x2), index, law, rows));
            }
            // Nothing is nearer: at the speed of the timed motion its own rows are the only ones.
            if best.as_ref().is_some_and(|(off, ..)| *off == zero) {
                break;
            }
        }
        self.first = trial.first;
        let Some((_, at, law, rows)) = best else { return false };
        if let Some(choice) = self.choice.get_mut(end) {
            *choice = at;
        }
        self.go(from, law, rows, phase);
        true
    }

    fn go(&mut self, from: T, law: Law<T>, rows: Rows<T>, phase: Phase) {
        (self.from, self.law, self.rows, self.phase) = (from, law, rows, phase);
        (self.duration, self.time) = (law.duration(), T::zero());
    }
}

/// The rows that are tried on a segment: those of the timed motion, and for each window with k = 0, with the k of the timed motion at the
/// speed of the window, and with that times a scale.
struct Candidates<T> {
    law: Law<T>,
    assumed: Assumed<T>,
    /// The timed motion's least and largest x.
    x: [T; 2],
    /// Without friction that is no line nothing depends on the window, and all rows have the same forms.
    curved: bool,
}

impl<T: RealField + Copy> Candidates<T> {
    fn new<const N: usize>(timing: &Timing<'_, T, N>, segment: &Segment<T, N>) -> Self {
        let Inner { law, assumed, .. } = segment.inner;
        let x = [law.x0.min(law.middle()).min(law.x2).max(T::zero()), law.x0.max(law.middle()).max(law.x2)];
        Self { law, assumed, x, curved: timing.friction.iter().any(JointFriction::is_curved) }
    }

    /// Of `ROWS`; `None` where they would be others again.
    fn rows(&self, index: usize, scale: Option<T>) -> Option<Rows<T>> {
        let Self { law, assumed, x: [least, most], curved } = *self;
        let Some(place) = index.checked_sub(1) else { return Some(Rows { k: law.k, assumed }) };
        let [from, to] = WINDOWS.get(place / 3).filter(|_| curved || place < 3)?.map(lit::<T>);
        let half = lit::<T>(0.5);
        let share = (from + to) * half;
        let k = [Some(T::zero()), Some(law.k * share), scale.map(|scale| law.k * scale)][place % 3]?;
        if !curved {
            return Some(Rows { k, assumed });
        }
        let top = if to < T::one() { most * to } else { assumed.x[1] };
        let touch = (law.x(half) * share).max(top * lit(1e-9)).max(lit(1e-30));
        Some(Rows { k, assumed: Assumed { x: [least * from, top], touch, u: assumed.u } })
    }
}

/// From which x at the start of a segment some rows lead to an x in `next`: the interval around the timed motion.
fn backwards<T: RealField + Copy, const N: usize>(timing: &Timing<'_, T, N>, segment: &Segment<T, N>, next: [T; 2]) -> [T; 2] {
    let candidates = Candidates::new(timing, segment);
    let (limits, friction, mut formed) = (&timing.limits, &timing.friction, Formed::new());
    let mut trial = Trial::new(segment, limits, friction, segment.inner.assumed, T::zero(), [None; 2], &mut formed);
    let found: [_; ROWS] = core::array::from_fn(|i| {
        let Rows { k, assumed } = candidates.rows(i, None)?;
        trial.backwards(k, &assumed, next, assumed.x[0], assumed.x[1])
    });
    let mut all = segment.inner.interval;
    for _ in 0..ROWS {
        for [low, high] in found.iter().flatten() {
            if *low <= all[1] && *high >= all[0] {
                all = [all[0].min(*low), all[1].max(*high)];
            }
        }
    }
    all
}
