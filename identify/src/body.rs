//! Rigid bodies as ten numbers: m, m c, and the tensor about the origin of their frame, in the order of the regressor `standard`.

use nalgebra::{Matrix3, Matrix4, Vector3};

/// m, mcx, mcy, mcz, Ixx, Ixy, Iyy, Ixz, Iyz, Izz.
pub type Ten = [f64; 10];

/// Names of the ten.
pub const NAMES: [&str; 10] = ["m", "mcx", "mcy", "mcz", "Ixx", "Ixy", "Iyy", "Ixz", "Iyz", "Izz"];

/// The second moments of a tensor: ½ tr(I) 1 - I.
pub fn second_moments(tensor: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::identity() * (0.5 * tensor.trace()) - tensor
}

/// The tensor of second moments: tr(S) 1 - S.
pub fn tensor(second: &Matrix3<f64>) -> Matrix3<f64> {
    Matrix3::identity() * second.trace() - second
}

/// The elements xx, xy, yy, xz, yz, zz.
pub fn elements(matrix: &Matrix3<f64>) -> [f64; 6] {
    [matrix[(0, 0)], matrix[(0, 1)], matrix[(1, 1)], matrix[(0, 2)], matrix[(1, 2)], matrix[(2, 2)]]
}

/// The symmetric matrix of the elements xx, xy, yy, xz, yz, zz.
pub fn symmetric(e: &[f64]) -> Matrix3<f64> {
    Matrix3::new(e[0], e[1], e[3], e[1], e[2], e[4], e[3], e[4], e[5])
}

/// The pseudo-inertia [[S, h], [h', m]], positive definite for every body with extent (Wensing, Kim and Slotine 2018).
pub fn pseudo_inertia(ten: &Ten) -> Matrix4<f64> {
    let s = second_moments(&symmetric(&ten[4..]));
    let mut j = Matrix4::zeros();
    j.fixed_view_mut::<3, 3>(0, 0).copy_from(&s);
    for i in 0..3 {
        (j[(i, 3)], j[(3, i)]) = (ten[1 + i], ten[1 + i]);
    }
    j[(3, 3)] = ten[0];
    j
}

/// The ten of a pseudo-inertia.
pub fn ten_of(j: &Matrix4<f64>) -> Ten {
    let e = elements(&tensor(&j.fixed_view::<3, 3>(0, 0).into_owned()));
    [j[(3, 3)], j[(0, 3)], j[(1, 3)], j[(2, 3)], e[0], e[1], e[2], e[3], e[4], e[5]]
}

/// The ten of a body of a mass, a centre of mass and a tensor about it.
pub fn ten(mass: f64, com: Vector3<f64>, about_com: &Matrix3<f64>) -> Ten {
    let about = about_com + mass * (Matrix3::identity() * com.dot(&com) - com * com.transpose());
    let e = elements(&about);
    [mass, mass * com[0], mass * com[1], mass * com[2], e[0], e[1], e[2], e[3], e[4], e[5]]
}

/// Mass, centre of mass and tensor about it; the mass is not 0.
pub fn about_com(ten: &Ten) -> (f64, Vector3<f64>, Matrix3<f64>) {
    let mass = ten[0];
    let com = Vector3::new(ten[1], ten[2], ten[3]) / mass;
    let tensor = symmetric(&ten[4..]) - mass * (Matrix3::identity() * com.dot(&com) - com * com.transpose());
    (mass, com, tensor)
}

/// The ten in another frame: x_new = rotation x + translation.
pub fn moved(ten: &Ten, rotation: &Matrix3<f64>, translation: Vector3<f64>) -> Ten {
    let mut x = Matrix4::identity();
    x.fixed_view_mut::<3, 3>(0, 0).copy_from(rotation);
    x.fixed_view_mut::<3, 1>(0, 3).copy_from(&translation);
    ten_of(&(x * pseudo_inertia(ten) * x.transpose()))
}
