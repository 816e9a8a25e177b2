//! The arrangements of the determinant for an arm of no class: of those in which it does not vanish the two with the fewest doubtful of
//! some fixed poses, then with the least noise, as the block itself finds them. Its bits are the same on every machine.

use armgen_inverse_kinematics::f64::{self as block, determinant_on_circle};

use super::chain::{Arrangement, Chain};
use super::frame::Frame;
use crate::exact::Number;
use armgen_algebra::scramble::scramble;

/// The number of poses for each arrangement.
const POSES: u64 = 128;

fn rounded(f: &Frame) -> block::Frame {
    f.each_ref().map(|row| row.each_ref().map(Number::to_f64))
}

impl Arrangement {
    /// With the nearest floats.
    fn rounded(&self) -> block::Arrangement<6> {
        block::Arrangement {
            order: std::array::from_fn(|i| self.order[i]),
            prismatic: std::array::from_fn(|i| self.prismatic[i]),
            links: std::array::from_fn(|i| rounded(&self.links[i])),
            open: self.open,
            before: rounded(&self.before),
            after: rounded(&self.after),
            backward: self.backward,
            offsets: std::array::from_fn(|i| self.offsets[i].each_ref().map(Number::to_f64)),
        }
    }
}

/// The pose of a fixed posture: T⁻¹ of the first arrangement's loop, in which the joints come in the arm's order; the last ones are `still` at 0.
fn pose(way: &block::Arrangement<6>, still: usize, length: f64, number: u64) -> block::Frame {
    let mut chain = way.after;
    for i in 0..6 {
        let x = scramble(8 * number + i as u64) as f64 / u64::MAX as f64 * 2.0 - 1.0;
        // An angle by its half angle's tangent is as good as any, and needs no sine.
        let t = x / (1.0 - x.abs() + 1e-3);
        let value = match way.prismatic[i] {
            _ if i + still >= 6 => way.offsets[i],
            true => [length * x, 0.0],
            false => [(1.0 - t * t) / (1.0 + t * t), 2.0 * t / (1.0 + t * t)],
        };
        let link = if i == 5 { way.before } else { way.links[i] };
        chain = block::compose(&chain, &block::joint_then(way.prismatic[i], value, &link));
    }
    chain
}

/// Whether block 9 finds the posture of each of some fixed poses: directions of slides that are in one plane with what they have to reach at
/// all poses, or joints that move nothing, leave an equation that vanishes.
pub(super) fn reaches(chain: &Chain, way: &Arrangement, slides: [usize; 2], length: &Number) -> bool {
    let (length, forward, floats) = (length.to_f64(), chain.arranged(0, false).rounded(), way.rounded());
    (0..8).all(|number| {
        let found = block::two_slides(&floats.links_at(&pose(&forward, chain.still, length, number)), slides, length);
        found.count > 0 && !found.continuum
    })
}

/// The two arrangements, the better one first.
pub(super) fn choose(chain: &Chain, length: &Number) -> Option<[Arrangement; 2]> {
    let length = length.to_f64();
    let forward = chain.arranged(0, false).rounded();
    let poses: Vec<block::Frame> = (0..POSES).map(|number| pose(&forward, chain.still, length, number)).collect();
    // The best two, the better one first; of equals the first in the order of arrangements.
    let mut best: Vec<(usize, f64, Arrangement)> = Vec::new();
    'arrangements: for way in chain.arrangements() {
        let [p1, p2, p3, p4, p5, p6] = std::array::from_fn(|i| way.prismatic[i]);
        if p3 || p6 || (p4 && p5) || ((p1 || p2) && (p4 || p5)) {
            continue;
        }
        let floats = way.rounded();
        let (mut vanishing, mut doubtful, mut noise) = (0, 0, 0.0);
        let is_less = |(d, n): (usize, f64), (x, y, _): &(usize, f64, Arrangement)| d.cmp(x).then(n.total_cmp(y)).is_lt();
        for t in &poses {
            let result = determinant_on_circle(&floats.links_at(t), floats.prismatic, length);
            doubtful += usize::from(!result.complete);
            vanishing += u64::from(result.free);
            noise += result.noise;
            // Some always vanish for arms with parallel or intersecting axes. None of the sums falls any more.
            if 2 * vanishing >= POSES || best.get(1).is_some_and(|second| !is_less((doubtful, noise), second)) {
                continue 'arrangements;
            }
        }
        let place = best.iter().position(|other| is_less((doubtful, noise), other)).unwrap_or(best.len());
        best.insert(place, (doubtful, noise, way));
        best.truncate(2);
    }
    let mut ways = best.into_iter().map(|(_, _, way)| way);
    let first = ways.next()?;
    // With one usable arrangement only, it is its own second.
    let second = ways.next().unwrap_or_else(|| first.clone());
    Some([first, second])
}
