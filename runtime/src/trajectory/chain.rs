//! The clock of a chain of segments: when each starts, and which are at work.

use super::PlanFault;
use core::time::Duration;

/// When one segment runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Slot {
    pub(crate) start: Duration,
    pub(crate) end: Duration,
}

/// The slot of the next segment, after `earlier` and, before it, `before_earlier`.
///
/// Only neighbours may overlap, so that never more than two segments are at work.
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
            let start = earlier.end.checked_sub(anticipation).ok_or(PlanFault::AnticipationTooLong)?;
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
