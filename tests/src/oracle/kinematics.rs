//! Frames and Jacobians.
//!
//! The axis of joint i is z of frame i-1 in standard rows and z of frame i in modified rows; other rows give it. Column i of the
//! geometric Jacobian of a point p is (z x (p - o); z) for a revolute joint with a point o of its axis, (z; 0) for a prismatic
//! one (the book, Sect. 3.1.3).

use super::vector::{add, constant, cross, scale, sub, Frame, Vector};
use super::{Dual, Matrix, Model, Placed, Scalar};

/// Posture of an arm: link frames and joint axes in the base frame.
pub(super) struct Posture<S> {
    /// Frames 0 (base) to n.
    pub(super) frames: Vec<Frame<S>>,
    /// End-effector frame.
    pub(super) end: Frame<S>,
    /// For each joint, direction of its axis and a point on it, both also fixed in the previous link. The point of a prismatic
    /// joint is the previous frame's origin.
    pub(super) axes: Vec<(Vector<S>, Vector<S>)>,
}

impl<S: Scalar> Posture<S> {
    pub(super) fn new(model: &Model, q: &[S]) -> Self {
        assert_eq!(q.len(), model.dof());
        let placed = |(r, p): Placed| Frame { r: r.map(constant), p: constant(p) };
        let mut frames = vec![Frame::base()];
        let mut axes = Vec::new();
        for (joint, &q) in model.joints.iter().zip(q) {
            let q_own = q;
            let [a, alpha, d, theta] = joint.row.map(S::from);
            let (d, theta) = if joint.prismatic { (d + q, theta) } else { (d, theta + q) };
            let previous = frames[joint.on].then(&placed(joint.start));
            if let Some((origin, axis)) = joint.origin {
                let still = previous.then(&placed(origin));
                let u = still.turn(constant(axis));
                let (frame, o) = match joint.prismatic {
                    true => (Frame { p: add(still.p, scale(q_own, u)), ..still }, previous.p),
                    false => (still.then(&about_vector(axis, q_own)), still.p),
                };
                axes.push((u, o));
                frames.push(frame);
                continue;
            }
            let frame = if model.modified {
                previous.about(0, alpha.sin_cos()).along(0, a).about(2, theta.sin_cos()).along(2, d)
            } else {
                previous.about(2, theta.sin_cos()).along(2, d).along(0, a).about(0, alpha.sin_cos())
            };
            axes.push(match (model.modified, joint.prismatic) {
                (true, false) => (frame.axis(2), frame.p),
                (true, true) => (frame.axis(2), previous.p),
                (false, _) => (previous.axis(2), previous.p),
            });
            frames.push(frame);
        }
        let end = frames[model.tip].then(&placed(model.tool));
        Posture { frames, end, axes }
    }

    /// Rows of the geometric Jacobian of the end effector's origin: linear, then angular.
    fn jacobian(&self, model: &Model) -> [Vec<S>; 6] {
        let mut rows: [Vec<S>; 6] = Default::default();
        for (i, (joint, &(z, o))) in model.joints.iter().zip(&self.axes).enumerate() {
            if !model.carries(i + 1, model.tip) {
                rows.iter_mut().for_each(|row| row.push(S::from(0.0)));
                continue;
            }
            let (linear, angular) = match joint.prismatic {
                true => (z, constant([0.0; 3])),
                false => (cross(z, sub(self.end.p, o)), z),
            };
            for i in 0..3 {
                rows[i].push(linear[i]);
                rows[i + 3].push(angular[i]);
            }
        }
        rows
    }
}

/// The turn about u, of length 1, by an angle: the columns are the axes turned, e + s u × e + (1 - c) u × (u × e).
fn about_vector<S: Scalar>(u: [f64; 3], angle: S) -> Frame<S> {
    let (s, c) = angle.sin_cos();
    let u = constant(u);
    let columns = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(|e| {
        let e: Vector<S> = constant(e);
        let aside = cross(u, e);
        add(e, add(scale(s, aside), scale(S::from(1.0) - c, cross(u, aside))))
    });
    Frame { r: [0, 1, 2].map(|i| [0, 1, 2].map(|j| columns[j][i])), p: constant([0.0; 3]) }
}

fn homogeneous(frame: &Frame<f64>) -> Matrix {
    let mut rows: Matrix = (0..3).map(|i| vec![frame.r[i][0], frame.r[i][1], frame.r[i][2], frame.p[i]]).collect();
    rows.push(vec![0.0, 0.0, 0.0, 1.0]);
    rows
}

impl Model {
    /// Link frames 1 to n in the base frame, each 4 x 4.
    pub fn link_frames(&self, q: &[f64]) -> Vec<Matrix> {
        Posture::new(self, q).frames[1..].iter().map(homogeneous).collect()
    }

    /// End-effector frame (frame n times tool) in the base frame, 4 x 4.
    pub fn direct_kinematics(&self, q: &[f64]) -> Matrix {
        homogeneous(&Posture::new(self, q).end)
    }

    /// Geometric Jacobian of the end effector in base axes, 6 x n: linear, then angular.
    pub fn geometric_jacobian(&self, q: &[f64]) -> Matrix {
        Posture::new(self, q).jacobian(self).to_vec()
    }

    /// Its time derivative along dq, 6 x n, by dual numbers.
    pub fn geometric_jacobian_dot(&self, q: &[f64], dq: &[f64]) -> Matrix {
        let rows = Posture::new(self, &Dual::along(q, dq)).jacobian(self);
        rows.iter().map(|row| row.iter().map(|x| x.derivative).collect()).collect()
    }

    /// The geometric Jacobian again, from the derivatives of the end-effector frame alone: (dp, the vector of dR R').
    ///
    /// Another way to the same, for the oracle's own tests.
    pub fn geometric_jacobian_by_differentiation(&self, q: &[f64]) -> Matrix {
        let mut rows = vec![vec![]; 6];
        for j in 0..self.dof() {
            let direction: Vec<f64> = (0..self.dof()).map(|i| f64::from(u8::from(i == j))).collect();
            let end = Posture::new(self, &Dual::along(q, &direction)).end;
            // S(omega) = dR R': element (i, k) is the sum over the columns of R.
            let spin = |i: usize, k: usize| -> f64 { (0..3).map(|c| end.r[i][c].derivative * end.r[k][c].value).sum() };
            for i in 0..3 {
                rows[i].push(end.p[i].derivative);
                rows[i + 3].push(spin((i + 2) % 3, (i + 1) % 3));
            }
        }
        rows
    }
}
