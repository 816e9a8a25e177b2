//! When each segment of a trajectory starts and ends, and which are active.

use super::PlanFault;
use core::time::Duration;

const NANOS_PER_SECOND: u64 = 1_000_000_000;

/// When one segment runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Slot {
    pub(crate) start: Duration,
    pub(crate) end: Duration,
}

/// Time from `earlier` to `later`; `None` where `later` comes first.
///
/// `Duration::checked_sub` gives the same, but ends in `Duration::new`, which panics where nanoseconds make a second too many.
/// That they never do here rests on an invariant of `Duration` that the optimiser does not see; `from_nanos` has no such case.
#[inline]
pub(crate) fn span(earlier: Duration, later: Duration) -> Option<Duration> {
    let seconds = later.as_secs().checked_sub(earlier.as_secs())?;
    let (from, to) = (u64::from(earlier.subsec_nanos()), u64::from(later.subsec_nanos()));
    let (seconds, nanos) = match to.checked_sub(from) {
        Some(nanos) => (seconds, nanos),
        None => (seconds.checked_sub(1)?, NANOS_PER_SECOND + to - from),
    };
    Duration::from_secs(seconds).checked_add(Duration::from_nanos(nanos))
}

/// The slot of the next segment, after `earlier` and, before it, `before_earlier`.
///
/// Only neighbours may overlap, so that never more than two segments are active.
pub(crate) fn next_slot(
    earlier: Option<Slot>,
    before_earlier: Option<Slot>,
    anticipation: Duration,
    duration: Duration,
) -> Result<Slot, PlanFault> {
    let start = match earlier {
        None if anticipation.is_zero() => Duration::ZERO,
        None => return Err(PlanFault::NothingToAnticipate),
        Some(earlier) => {
            let start = span(anticipation, earlier.end).ok_or(PlanFault::AnticipationTooLong)?;
            let free = before_earlier.map_or(Duration::ZERO, |slot| slot.end);
            if start < earlier.start || start < free || anticipation > duration {
                return Err(PlanFault::AnticipationTooLong);
            }
            start
        }
    };
    Ok(Slot { start, end: start.checked_add(duration).ok_or(PlanFault::TooLong)? })
}

/// Index of the last of `slots` that has started at `t`; the first starts at zero.
#[inline]
pub(crate) fn last_started<S>(slots: &[S], slot: impl Fn(&S) -> Slot, t: Duration) -> usize {
    slots.partition_point(|s| slot(s).start <= t).saturating_sub(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_span_is_the_difference_of_two_durations() {
        let times = [0, 1, 2].into_iter().flat_map(|s| [0, 1, 499_999_999, 999_999_999].map(|n| Duration::new(s, n)));
        let times: [Duration; 13] = {
            let mut all = [Duration::MAX; 13];
            times.enumerate().for_each(|(i, t)| all[i] = t);
            all
        };
        for earlier in times {
            for later in times {
                assert_eq!(span(earlier, later), later.checked_sub(earlier), "from {earlier:?} to {later:?}");
            }
        }
    }
}
