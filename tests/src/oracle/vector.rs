//! Vectors of the space and frames, over any [`Scalar`].

use std::array::from_fn;

use super::Scalar;

pub(super) type Vector<S> = [S; 3];

pub(super) fn constant<S: Scalar>(v: [f64; 3]) -> Vector<S> {
    v.map(S::from)
}

pub(super) fn add<S: Scalar>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    from_fn(|i| a[i] + b[i])
}

pub(super) fn sub<S: Scalar>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    from_fn(|i| a[i] - b[i])
}

pub(super) fn scale<S: Scalar>(s: S, v: Vector<S>) -> Vector<S> {
    v.map(|x| s * x)
}

pub(super) fn dot<S: Scalar>(a: Vector<S>, b: Vector<S>) -> S {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(super) fn cross<S: Scalar>(a: Vector<S>, b: Vector<S>) -> Vector<S> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// A frame in the base frame: rotation by rows, origin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame<S> {
    pub(super) r: [[S; 3]; 3],
    pub(super) p: Vector<S>,
}

impl<S: Scalar> Frame<S> {
    pub(super) fn base() -> Self {
        Frame { r: from_fn(|i| from_fn(|j| S::from(f64::from(u8::from(i == j))))), p: constant([0.0; 3]) }
    }

    /// A direction of this frame, in the base frame.
    pub(super) fn turn(&self, v: Vector<S>) -> Vector<S> {
        self.r.map(|row| dot(row, v))
    }

    /// Column j of the rotation: an axis of the frame.
    pub(super) fn axis(&self, j: usize) -> Vector<S> {
        self.r.map(|row| row[j])
    }

    /// The frame `inner`, given in this frame, in the base frame.
    pub(super) fn then(&self, inner: &Frame<S>) -> Self {
        let columns: [Vector<S>; 3] = from_fn(|j| self.turn(inner.axis(j)));
        Frame { r: from_fn(|i| from_fn(|j| columns[j][i])), p: add(self.p, self.turn(inner.p)) }
    }

    /// Turned about its own axis j (0: x, 2: z) by an angle with this sine and cosine.
    pub(super) fn about(&self, j: usize, (s, c): (S, S)) -> Self {
        let (o, l) = (S::from(0.0), S::from(1.0));
        let r = match j {
            0 => [[l, o, o], [o, c, -s], [o, s, c]],
            _ => [[c, -s, o], [s, c, o], [o, o, l]],
        };
        self.then(&Frame { r, p: constant([0.0; 3]) })
    }

    /// Moved along its own axis j.
    pub(super) fn along(&self, j: usize, distance: S) -> Self {
        Frame { r: self.r, p: add(self.p, scale(distance, self.axis(j))) }
    }
}
