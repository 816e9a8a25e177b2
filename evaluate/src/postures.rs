//! Inverse kinematics of an arm, as the calls of compiled blocks.

use armgen_codegen::inverse_kinematics as exact;
use armgen_codegen::kinds::{JointKind, Target};
use armgen_codegen::manipulator::Manipulator;
use armgen_numbers::postures::{
    Arrangement, Case, Construction, Coordinates, Frame, Given, InverseKinematics, Redundancy, Solver, Sums,
};

use crate::Scalar;

/// The inverse kinematics of an arm. Its results have the bits of the emitted module of the same scalar.
///
/// Errors: the reason why the arm has no inverse kinematics, for people.
pub fn solver<T: Scalar>(manipulator: &Manipulator) -> Result<Solver<T>, String> {
    let found = exact::of(manipulator)?;
    Ok(Solver::new(inverse_kinematics(manipulator, &found)).expect("the parts of a construction fit each other"))
}

/// A construction of codegen as data of `armgen-numbers`.
pub fn inverse_kinematics<T: Scalar>(manipulator: &Manipulator, found: &exact::InverseKinematics) -> InverseKinematics<T> {
    let way = arrangement::<T>;
    let case = |regional: &exact::Regional| Case::of_block(regional.function).expect("a case of a block");
    let construction = match &found.construction {
        exact::Construction::SphericalTriple(of, regional) => Construction::SphericalTriple(way(of), case(regional)),
        exact::Construction::ThreeParallel(of, polished) => Construction::ThreeParallel(way(of), *polished),
        exact::Construction::ParallelTurns(of, regional) => Construction::ParallelTurns(way(of), case(regional)),
        exact::Construction::Position(of, regional) => Construction::Position(way(of), case(regional)),
        exact::Construction::ThreePrismatic(of, turning) => Construction::ThreePrismatic(way(of), *turning),
        exact::Construction::TwoSlides(of, slides) => Construction::TwoSlides(way(of), *slides),
        exact::Construction::ShoulderElbowWrist(of) => Construction::ShoulderElbowWrist(way(of)),
        exact::Construction::General(ways) => Construction::General(Box::new(ways.each_ref().map(way))),
    };
    let redundancy = found.redundancy.as_ref().map(|redundancy| match redundancy {
        exact::Redundancy::Joint(given) => Redundancy::Joint(Given {
            joint: given.joint,
            place: given.place,
            prismatic: given.prismatic,
            before: frame(&given.before),
            after: frame(&given.after),
        }),
        exact::Redundancy::Swivel => Redundancy::Swivel,
    });
    InverseKinematics {
        prismatic: manipulator.coordinates().iter().map(|of| of.joint.kind == JointKind::Prismatic).collect(),
        orientation: found.target != Target::Position,
        construction,
        most: found.most,
        branches: found.branches(),
        length: T::nearest(&found.length),
        redundancy,
        own: found.own.as_ref().map(way),
        coordinates: found.coordinates.as_ref().map(|of| Coordinates {
            joints: of.slides.clone(),
            variables: sums(&of.variables),
            coordinates: sums(&of.coordinates),
        }),
    }
}

fn sums<T: Scalar>(exact: &exact::Sums) -> Sums<T> {
    Sums {
        factors: exact.factors.iter().map(|row| row.iter().map(T::nearest).collect()).collect(),
        offset: exact.offset.iter().map(T::nearest).collect(),
    }
}

fn frame<T: Scalar>(exact: &exact::Frame) -> Frame<T> {
    exact.each_ref().map(|row| row.each_ref().map(T::nearest))
}

fn arrangement<T: Scalar>(way: &exact::Arrangement) -> Arrangement<T> {
    Arrangement {
        order: way.order.clone(),
        prismatic: way.prismatic.clone(),
        links: way.links.iter().map(frame).collect(),
        open: way.open,
        before: frame(&way.before),
        after: frame(&way.after),
        backward: way.backward,
        offsets: way.offsets.iter().map(|offset| offset.each_ref().map(T::nearest)).collect(),
    }
}
