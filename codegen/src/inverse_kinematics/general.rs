//! The arrangements of the determinant for an arm of no class: of those in which it does not vanish the two with the fewest doubtful of
//! some fixed poses, then with the least noise, as the block itself finds them. Its bits are the same on every machine.

use armgen_inverse_kinematics::f64::{self as block, determinant_on_circle};

use super::chain::{Arrangement, Chain};
use super::frame::Frame;
use crate::exact::Number;
use armgen_algebra::scramble::scramble;

/// So many poses are tried an arrangement.
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

/// At how many of some fixed poses block 9 does not tell how many postures there are, as where each root of its polynomial is a double one;
/// nothing where it does not find the posture of one: directions of slides that are in one plane with what they have to reach at all poses, or joints
/// that move nothing, leave an equation that vanishes.
pub(super) fn doubtful(chain: &Chain, way: &Arrangement, slides: [usize; 2], length: &Number) -> Option<usize> {
    let (length, forward, floats) = (length.to_f64(), chain.arranged(0, false).rounded(), way.rounded());
    (0..8).try_fold(0, |doubtful, number| {
        let links = floats.links_at(&pose(&forward, chain.still, length, number));
        let found = block::two_slides(&links, floats.open, slides, length);
        (found.count > 0 && !found.continuum).then(|| doubtful + usize::from(found.near))
    })
}

/// The two arrangements, the better one first. The second leaves another joint for last, if there is one that serves: solutions that share the value
/// of the one joint do not share that of the other.
pub(super) fn choose(chain: &Chain, length: &Number) -> Option<[Arrangement; 2]> {
    let length = length.to_f64();
    let forward = chain.arranged(0, false).rounded();
    let poses: Vec<block::Frame> = (0..POSES).map(|number| pose(&forward, chain.still, length, number)).collect();
    // Those that serve, better ones first; of equals in the order of arrangements.
    let mut serving: Vec<(usize, f64, Arrangement)> = Vec::new();
    'arrangements: for way in chain.arrangements() {
        let [p1, p2, p3, p4, p5, p6] = std::array::from_fn(|i| way.prismatic[i]);
        if p3 || p6 || (p4 && p5) || ((p1 || p2) && (p4 || p5)) {
            continue;
        }
        let floats = way.rounded();
        let (mut vanishing, mut doubtful, mut noise) = (0, 0, 0.0);
        for t in &poses {
            let result = determinant_on_circle(&floats.links_at(t), floats.prismatic, length);
            doubtful += usize::from(!result.complete || result.crowded);
            vanishing += u64::from(result.free);
            noise += result.noise;
            // Some always vanish for arms with parallel or intersecting axes.
            if 2 * vanishing >= POSES {
                continue 'arrangements;
            }
        }
        serving.push((doubtful, noise, way));
    }
    serving.sort_by(|(d, n, _), (e, m, _)| d.cmp(e).then(n.total_cmp(m)));
    let (_, _, first) = serving.first()?;
    let other = serving.iter().find(|(doubtful, _, way)| way.order[2] != first.order[2] && 2 * *doubtful < poses.len());
    // With one usable arrangement only, it is its own second.
    let (_, _, second) = other.or(serving.get(1)).unwrap_or(&serving[0]);
    Some([first.clone(), second.clone()])
}
