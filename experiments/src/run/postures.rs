//! Manipulability in postures: pose, w, and the ellipsoids of the translation in a plane.

use armgen_runtime::manipulability::{
    condition_number, distance_to_singularity, force_ellipsoid, manipulability, velocity_ellipsoid, Ellipsoid,
};
use armgen_runtime::nalgebra::{SMatrix, SVector, Vector3};
use armgen_runtime::reference::Pose;
use armgen_runtime::task::{Row, Task};

use super::implausible_settings::joints_of_end_effector;
use super::instance::Functions;
use super::Instance;
use crate::model::{Channel, PostureQuantity, Postures, Quantity, Record, Shape, Shapes};

/// Direction of a semi-axis, deg, in (-90, 90], because an axis has no sign.
fn degrees(ellipsoid: &Ellipsoid<f64, 2>, i: usize) -> f64 {
    let d = ellipsoid.directions[(1, i)].atan2(ellipsoid.directions[(0, i)]).to_degrees().rem_euclid(180.0);
    if d > 90.0 {
        d - 180.0
    } else {
        d
    }
}

impl<R: Functions<N, P>, W, const N: usize, const M: usize, const P: usize> Instance<R, W, N, M, P> {
    /// Manipulability of the whole task.
    pub(super) fn manipulability(&self, q: &SVector<f64, N>) -> f64 {
        manipulability(&self.task.jacobian(&self.nominal.geometric_jacobian(q)))
    }

    /// The Jacobian in the plane of two rows.
    fn plane(&self, plane: [Row; 2], q: &SVector<f64, N>) -> SMatrix<f64, 2, N> {
        let task = Task::new(plane).expect("the file has been checked: no row stands twice");
        task.jacobian(&self.nominal.geometric_jacobian(q))
    }

    fn shape(&self, plane: [Row; 2], q: &SVector<f64, N>) -> Shape {
        let j = self.plane(plane, q);
        let origin = |t: &armgen_runtime::nalgebra::Matrix4<f64>| Vector3::new(t[(0, 3)], t[(1, 3)], t[(2, 3)]);
        let mut points = vec![Vector3::zeros()];
        let frames = self.nominal.link_frames(q);
        points.extend(joints_of_end_effector(&self.nominal, q).into_iter().map(|i| origin(&frames[i])));
        points.push(origin(&self.nominal.direct_kinematics(q)));
        Shape { points, velocity: velocity_ellipsoid(&j), force: force_ellipsoid(&j) }
    }

    pub(super) fn judge_postures(&self, postures: &Postures, numbers: Vec<Channel>) -> Record {
        let shapes = Shapes {
            postures: postures.list.iter().map(|posture| self.shape(postures.plane, &Self::joints(&posture.q))).collect(),
            grid: self.grid(postures),
        };
        let value = |channel: &Channel| match channel.quantity {
            Quantity::Posture(quantity, i) => {
                self.value(postures, &shapes.postures[i], quantity, &Self::joints(&postures.list[i].q))
            }
            _ => f64::NAN,
        };
        let numbers = numbers.into_iter().map(|channel| {
            let value = value(&channel);
            (channel, value)
        });
        let numbers = numbers.collect();
        let mut record = Record::default();
        (record.numbers, record.shapes) = (numbers, shapes);
        record
    }

    /// The arm in all combinations of values of the first two joints, with the others at zero.
    fn grid(&self, postures: &Postures) -> Vec<Shape> {
        let Some([first, second]) = &postures.grid else { return Vec::new() };
        let all = first.iter().flat_map(|a| second.iter().map(move |b| [*a, *b]));
        let joints = |values: [f64; 2]| SVector::from_fn(|i, _| values.get(i).copied().unwrap_or(0.0));
        all.map(|values| self.shape(postures.plane, &joints(values))).collect()
    }

    fn value(&self, postures: &Postures, shape: &Shape, quantity: PostureQuantity, q: &SVector<f64, N>) -> f64 {
        let [a, b] = postures.plane.map(Row::index);
        let pose = || Pose::of(&self.nominal, q);
        match quantity {
            PostureQuantity::Tip(axis) => pose().position[axis],
            PostureQuantity::Manipulability => self.manipulability(q),
            // The angle of the end effector's y axis in the plane.
            PostureQuantity::Heading => pose().rotation[(b, 1)].atan2(pose().rotation[(a, 1)]),
            PostureQuantity::Velocity(i) => shape.velocity.semi_axes[i],
            PostureQuantity::Direction(i) => degrees(&shape.velocity, i),
            PostureQuantity::Force(i) => shape.force.map_or(f64::INFINITY, |force| force.semi_axes[i]),
            PostureQuantity::Condition => condition_number(&self.plane(postures.plane, q)).unwrap_or(f64::INFINITY),
            PostureQuantity::Distance => distance_to_singularity(&self.plane(postures.plane, q)),
        }
    }
}
