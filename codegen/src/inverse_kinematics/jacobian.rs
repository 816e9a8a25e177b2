//! The rank of an arm's Jacobian at a general posture: at a random one of a prime field, where it is that of nearly all postures.

use super::chain::{Chain, Given};
use super::frame::{compose, Frame};
use crate::ring::field::{Element, Field};
use armgen_algebra::scramble::scramble;

/// The Jacobian of the end effector at a random posture, in the base frame.
pub(super) struct Jacobian {
    field: Field,
    /// The column of each joint: (z × (t - p), z) for an axis z through p and the end effector at t, or (z, 0) for a prismatic
    /// joint.
    columns: Vec<[Element; 6]>,
}

impl Jacobian {
    /// The Jacobian with the virtual joints at 0; a joint after them may be `taken`. `None` if the field lacks a root.
    pub(super) fn of(chain: &Chain, taken: Option<&Given>) -> Option<Jacobian> {
        let (way, own) = (chain.arranged(0, false), chain.joints.len() - chain.still);
        let tool = match taken.filter(|given| given.joint > 0) {
            Some(given) => compose(&way.before, &given.link(0)),
            None => way.before.clone(),
        };
        let link = |place| if place == way.open { tool.clone() } else { way.link(place, 0) };
        let links: Vec<Frame> = (0..way.order.len()).map(link).collect();
        let frames = links.iter().chain([&way.after]);
        let mut field = Field::with_roots_of(frames.flatten().flatten().chain(way.offsets.iter().flatten()))?;
        let frame = |field: &mut Field, frame: &Frame| -> [[Element; 4]; 3] {
            frame.each_ref().map(|row| row.each_ref().map(|x| field.number(x)))
        };
        let mut at = frame(&mut field, &way.after);
        let mut axes = Vec::new();
        for (place, link) in links.iter().enumerate() {
            axes.push((at.map(|row| row[2]), at.map(|row| row[3])));
            let link = frame(&mut field, link);
            let offset = way.offsets[place].each_ref().map(|x| field.number(x));
            let random = field.from_u64(scramble(7 + place as u64));
            let (zero, one) = (field.zero(), field.one());
            let moved = match (way.prismatic[place], place < own) {
                (true, true) => (one, zero, random),
                (true, false) => (one, zero, offset[0]),
                (false, true) => {
                    let (s, c) = field.circle(random);
                    (c, s, zero)
                }
                (false, false) => (offset[0], offset[1], zero),
            };
            at = stepped(&field, &at, moved, &link);
        }
        let (tip, zero) = (at.map(|row| row[3]), field.zero());
        let column = |((z, p), slides): (&([Element; 3], [Element; 3]), &bool)| {
            let [x, y, w] = if *slides { *z } else { cross(&field, *z, std::array::from_fn(|i| field.sub(tip[i], p[i]))) };
            let [u, v, t] = if *slides { [zero; 3] } else { *z };
            [x, y, w, u, v, t]
        };
        let columns = axes.iter().zip(&way.prismatic).map(column).collect();
        Some(Jacobian { field, columns })
    }

    /// The rank of its first rows: three of the position, all six of the pose.
    pub(super) fn rank(&self, rows: usize) -> usize {
        let (field, mut columns) = (&self.field, self.columns.clone());
        let mut rank = 0;
        for entry in 0..rows {
            let Some(pivot) = (rank..columns.len()).find(|k| columns[*k][entry] != field.zero()) else { continue };
            columns.swap(rank, pivot);
            let over = field.inverse(columns[rank][entry]);
            let pivot = columns[rank];
            for column in columns.iter_mut().skip(rank + 1) {
                let factor = field.mul(column[entry], over);
                for (x, y) in column.iter_mut().zip(&pivot) {
                    *x = field.sub(*x, field.mul(factor, *y));
                }
            }
            rank += 1;
        }
        rank
    }

    /// Whether no joint moves the end effector along an axis of the base frame.
    pub(super) fn is_still(&self, axis: usize) -> bool {
        self.columns.iter().all(|column| column[axis] == self.field.zero())
    }
}

fn cross(field: &Field, p: [Element; 3], z: [Element; 3]) -> [Element; 3] {
    let minor = |i: usize, j: usize| field.sub(field.mul(p[i], z[j]), field.mul(p[j], z[i]));
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

/// A frame after Rz Tz of (c, s, d) and a link.
fn stepped(
    field: &Field,
    at: &[[Element; 4]; 3],
    (c, s, d): (Element, Element, Element),
    link: &[[Element; 4]; 3],
) -> [[Element; 4]; 3] {
    let sum = |x: Element, y: Element| field.add(x, y);
    let turned = at.map(|[x, y, z, p]| {
        let (u, v) = (sum(field.mul(x, c), field.mul(y, s)), field.sub(field.mul(y, c), field.mul(x, s)));
        [u, v, z, sum(p, field.mul(z, d))]
    });
    turned.map(|row| {
        std::array::from_fn(|j| {
            let product = (0..3).fold(field.zero(), |total, k| sum(total, field.mul(row[k], link[k][j])));
            if j == 3 {
                sum(product, row[3])
            } else {
                product
            }
        })
    })
}
