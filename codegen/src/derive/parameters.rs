//! The parameter vector pi: the columns of the regressor, and each entry of the model as a function of pi.

use std::cell::RefCell;

use crate::exact::{Number, Polynomial, Rational};
use crate::kinds::ParameterId;
use crate::manipulator::{Body, Manipulator, PlacedBody, Placement, Row};
use crate::ring::{ExprId, Pool, Symbol};

/// One of the parameters in which the dynamics of every arm are linear.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum StandardParameter {
    /// One of a link, in its link frame.
    Link(u16, Inertial),
    /// Inertia of the rotor of a joint about its axis.
    RotorInertia(u16),
    /// Inertia that a joint alone feels.
    Armature(u16),
    /// Viscous friction at the rotor of a joint.
    RotorViscous(u16),
    /// Viscous friction at a joint.
    Viscous(u16),
    /// Coulomb friction at a joint.
    Coulomb(u16),
    /// Friction at a joint whatever its rate.
    Offset(u16),
    /// Cubic friction at a joint.
    Cubic(u16),
    /// Stribeck friction at a joint.
    Stribeck(u16),
    /// Stiffness of the spring of a joint.
    Stiffness(u16),
    /// One of a payload, by its number, in the frame of its end effector.
    Payload(u8, Inertial),
}

/// An inertial parameter of a body in a frame: mass, first moments m c, moments and products of inertia about the frame's origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Inertial {
    /// m.
    M,
    /// m c_x.
    Mcx,
    /// m c_y.
    Mcy,
    /// m c_z.
    Mcz,
    /// Ixx.
    Ixx,
    /// Ixy = -∫xy dm.
    Ixy,
    /// Iyy.
    Iyy,
    /// Ixz = -∫xz dm.
    Ixz,
    /// Iyz = -∫yz dm.
    Iyz,
    /// Izz.
    Izz,
    /// Ixx of a planar body, which has no extent along z: Izz = Ixx + Iyy. The convention
    /// [`GroupingConvention::NoSecondMomentAlongAxis`](super::arm::GroupingConvention) leaves such bodies.
    PlanarIxx,
    /// Iyy of a planar body.
    PlanarIyy,
}

impl Inertial {
    /// The ten of any body.
    pub const TEN: [Inertial; 10] = [
        Inertial::M,
        Inertial::Mcx,
        Inertial::Mcy,
        Inertial::Mcz,
        Inertial::Ixx,
        Inertial::Ixy,
        Inertial::Iyy,
        Inertial::Ixz,
        Inertial::Iyz,
        Inertial::Izz,
    ];

    /// How many there are, the two of planar bodies included.
    pub const COUNT: usize = Inertial::TEN.len() + 2;

    /// Its place among all of them.
    pub fn index(self) -> usize {
        self as usize
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Inertial::M => "m",
            Inertial::Mcx => "mcx",
            Inertial::Mcy => "mcy",
            Inertial::Mcz => "mcz",
            Inertial::Ixx | Inertial::PlanarIxx => "Ixx",
            Inertial::Ixy => "Ixy",
            Inertial::Iyy | Inertial::PlanarIyy => "Iyy",
            Inertial::Ixz => "Ixz",
            Inertial::Iyz => "Iyz",
            Inertial::Izz => "Izz",
        }
    }

    /// Its meaning, with its unit.
    fn meaning(self) -> &'static str {
        match self {
            Inertial::M => "mass, kg",
            Inertial::Mcx => "first moment m cx, kg m",
            Inertial::Mcy => "first moment m cy, kg m",
            Inertial::Mcz => "first moment m cz, kg m",
            Inertial::Ixx => "inertia Ixx about the frame's origin, kg m²",
            Inertial::Ixy => "inertia Ixy = -∫xy dm about the frame's origin, kg m²",
            Inertial::Iyy => "inertia Iyy about the frame's origin, kg m²",
            Inertial::Ixz => "inertia Ixz = -∫xz dm about the frame's origin, kg m²",
            Inertial::Iyz => "inertia Iyz = -∫yz dm about the frame's origin, kg m²",
            Inertial::Izz => "inertia Izz about the frame's origin, kg m²",
            Inertial::PlanarIxx => "inertia Ixx about the frame's origin, with as much in Izz, kg m²",
            Inertial::PlanarIyy => "inertia Iyy about the frame's origin, with as much in Izz, kg m²",
        }
    }
}

impl StandardParameter {
    /// Whether its torque is one of friction.
    pub fn is_friction(self) -> bool {
        use StandardParameter::*;
        matches!(self, RotorViscous(_) | Viscous(_) | Coulomb(_) | Offset(_) | Cubic(_) | Stribeck(_))
    }

    /// All that a description gives, in the order of the regressor `standard`.
    pub fn all(manipulator: &Manipulator) -> Vec<StandardParameter> {
        let mut all = Vec::new();
        for i in 0..manipulator.joints.len() as u16 {
            all.extend(Inertial::TEN.map(|k| StandardParameter::Link(i, k)));
        }
        for (i, joint) in manipulator.joints.iter().enumerate() {
            let i = i as u16;
            if joint.motor.as_ref().is_some_and(|m| m.inertia.is_some()) {
                all.push(StandardParameter::RotorInertia(i));
            }
            if joint.armature.is_some() {
                all.push(StandardParameter::Armature(i));
            }
            if joint.motor.as_ref().is_some_and(|m| m.viscous.is_some()) {
                all.push(StandardParameter::RotorViscous(i));
            }
            if joint.viscous.is_some() {
                all.push(StandardParameter::Viscous(i));
            }
            if joint.coulomb.is_some() {
                all.push(StandardParameter::Coulomb(i));
            }
            if joint.offset.is_some() {
                all.push(StandardParameter::Offset(i));
            }
            if joint.cubic.is_some() {
                all.push(StandardParameter::Cubic(i));
            }
            if joint.stribeck.is_some() {
                all.push(StandardParameter::Stribeck(i));
            }
            if joint.spring.is_some() {
                all.push(StandardParameter::Stiffness(i));
            }
        }
        for (_, number) in manipulator.loads().iter().zip(0..) {
            all.extend(Inertial::TEN.map(|k| StandardParameter::Payload(number, k)));
        }
        all
    }

    /// Its name: `m1`, `Ixx1`, `Im1`, `Ia1`, `Fm1`, `Fv1`, `Fc1`, `F0_1`, `F3_1`, `Fs1`, `ks1`, `mp`.
    pub fn name(self) -> String {
        match self {
            StandardParameter::Link(i, k) => format!("{}{}", k.name(), i + 1),
            StandardParameter::RotorInertia(i) => format!("Im{}", i + 1),
            StandardParameter::Armature(i) => format!("Ia{}", i + 1),
            StandardParameter::RotorViscous(i) => format!("Fm{}", i + 1),
            StandardParameter::Viscous(i) => format!("Fv{}", i + 1),
            StandardParameter::Coulomb(i) => format!("Fc{}", i + 1),
            StandardParameter::Offset(i) => format!("F0_{}", i + 1),
            StandardParameter::Cubic(i) => format!("F3_{}", i + 1),
            StandardParameter::Stribeck(i) => format!("Fs{}", i + 1),
            StandardParameter::Stiffness(i) => format!("ks{}", i + 1),
            StandardParameter::Payload(_, k) => format!("{}p", k.name()),
        }
    }

    /// The same with the name of the end effector before that of a payload's, where it has a name.
    pub fn full_name(self, manipulator: &Manipulator) -> String {
        let of = match self {
            StandardParameter::Payload(number, _) => manipulator.loads()[usize::from(number)].of,
            _ => None,
        };
        of.map_or(String::new(), |tip| format!("{tip}_")) + &self.name()
    }

    /// The value or the bodies that give it.
    fn entry(self, manipulator: &Manipulator) -> Entry<'_> {
        let joint = |i: u16| &manipulator.joints[usize::from(i)];
        let motor = |i: u16| joint(i).motor.as_ref();
        match self {
            StandardParameter::Link(i, k) => Entry::OfBodies(&joint(i).link, k),
            StandardParameter::RotorInertia(i) => Entry::Whole(motor(i).and_then(|m| m.inertia.as_ref())),
            StandardParameter::Armature(i) => Entry::Whole(joint(i).armature.as_ref()),
            StandardParameter::RotorViscous(i) => Entry::Whole(motor(i).and_then(|m| m.viscous.as_ref())),
            StandardParameter::Viscous(i) => Entry::Whole(joint(i).viscous.as_ref()),
            StandardParameter::Coulomb(i) => Entry::Whole(joint(i).coulomb.as_ref()),
            StandardParameter::Offset(i) => Entry::Whole(joint(i).offset.as_ref()),
            StandardParameter::Cubic(i) => Entry::Whole(joint(i).cubic.as_ref()),
            StandardParameter::Stribeck(i) => Entry::Whole(joint(i).stribeck.as_ref().map(|stribeck| &stribeck.torque)),
            StandardParameter::Stiffness(i) => Entry::Whole(joint(i).spring.as_ref().map(|spring| &spring.stiffness)),
            StandardParameter::Payload(number, k) => {
                Entry::OfBodies(std::slice::from_ref(manipulator.loads()[usize::from(number)].body), k)
            }
        }
    }

    /// Its value at the nominal values of all names.
    pub fn nominal(self, manipulator: &Manipulator) -> Number {
        match self.entry(manipulator) {
            Entry::Whole(value) => value.map_or_else(Number::zero, |value| nominal(manipulator, value)),
            Entry::OfBodies(bodies, k) => bodies.iter().fold(Number::zero(), |sum, part| {
                let mut number = |polynomial: &Polynomial| nominal(manipulator, polynomial);
                let of = inertial(&part.body, k, &mut number, &mut Number::times, &mut Number::plus, &mut |a| -a);
                sum.plus(&of)
            }),
        }
    }
}

/// Where a standard parameter is found.
enum Entry<'a> {
    /// It is given as such.
    Whole(Option<&'a Polynomial>),
    /// The sum over bodies in one frame: first and second moments about one origin add.
    OfBodies(&'a [PlacedBody], Inertial),
}

/// An inertial parameter of a body about the origin of its frame: m, m c, I_c + m (c'c 1 - c c'), where `of` gives the entries of the
/// body, and the others are the operations on what it gives.
fn inertial<T>(
    body: &Body,
    parameter: Inertial,
    of: &mut dyn FnMut(&Polynomial) -> T,
    mul: &mut dyn FnMut(&T, &T) -> T,
    add: &mut dyn FnMut(&T, &T) -> T,
    neg: &mut dyn FnMut(&T) -> T,
) -> T {
    let mut square = |of: &mut dyn FnMut(&Polynomial) -> T, i: usize, j: usize| {
        let (m, a, b) = (of(&body.mass), of(&body.com[i]), of(&body.com[j]));
        let moment = mul(&m, &a);
        mul(&moment, &b)
    };
    // Of a moment of inertia the two coordinates whose squares it takes, which are added; of a product of inertia the two whose product
    // is taken away.
    let (element, moment, (i, j)) = match parameter {
        Inertial::M => return of(&body.mass),
        Inertial::Mcx | Inertial::Mcy | Inertial::Mcz => {
            let (m, c) = (of(&body.mass), of(&body.com[parameter.index() - Inertial::Mcx.index()]));
            return mul(&m, &c);
        }
        Inertial::Ixx | Inertial::PlanarIxx => (0, true, (1, 2)),
        Inertial::Ixy => (1, false, (0, 1)),
        Inertial::Iyy | Inertial::PlanarIyy => (2, true, (0, 2)),
        Inertial::Ixz => (3, false, (0, 2)),
        Inertial::Iyz => (4, false, (1, 2)),
        Inertial::Izz => (5, true, (0, 1)),
    };
    let element = of(&body.inertia[element]);
    if moment {
        let (one, other) = (square(of, i, i), square(of, j, j));
        let sum = add(&element, &one);
        add(&sum, &other)
    } else {
        let product = square(of, i, j);
        add(&element, &neg(&product))
    }
}

/// Products of polynomials with more terms than this are formed by the pool, which shares the factors.
const EXPANDED_TERMS: usize = 64;

/// Whether the products m c c' of a body stay short.
fn stays_short(body: &Body) -> bool {
    let terms = |p: &Polynomial| p.terms().count();
    let longest = body.com.iter().map(terms).max().unwrap_or(0);
    terms(&body.mass) * longest * longest <= EXPANDED_TERMS
}

/// The columns of the regressor.
#[derive(Clone, Debug)]
pub struct ParameterVector {
    /// One entry per column.
    pub entries: Vec<Parameter>,
    /// The kind of its entries.
    pub kind: ParameterKind,
}

/// An entry of a parameter vector.
#[derive(Clone, Debug)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// Its value in the description.
    pub nominal: Number,
    /// Its meaning, for people.
    pub meaning: String,
}

/// The meaning of the entries.
#[derive(Clone, Debug)]
pub enum ParameterKind {
    /// The standard parameters themselves.
    Standard(Vec<StandardParameter>),
    /// The base parameters: the independent ones among the parameters of rotors, friction and of the links in their *joint frames*. All others
    /// are set to zero and their effect is carried by these.
    Base(Vec<StandardParameter>),
    /// Names of the description.
    Names(Vec<ParameterId>),
}

/// How the quantities of a description enter the equations.
#[derive(Clone, Copy, Debug)]
pub enum View<'a> {
    /// Everything a number.
    Nominal,
    /// Every name of the description a symbol.
    Symbolic,
    /// The entries of the parameter vector symbols, everything else a number.
    Vector(&'a ParameterVector),
    /// The entries of the parameter vector zero, everything else a number: the known part remains.
    VectorZero(&'a ParameterVector),
}

/// The value of a standard parameter at the nominal values of all names.
pub fn nominal(manipulator: &Manipulator, value: &Polynomial) -> Number {
    value.evaluate(&|id| manipulator.parameters[id.0 as usize].nominal.clone())
}

/// a, alpha, d and theta of a Denavit-Hartenberg row at the nominal values of all names, without `base`. Its last two elements before the motion are
/// Rx(alpha) Tx(a) and Rz(theta) Tz(d) in the modified convention. In the standard convention Tx(a) Rx(alpha) follows the motion.
pub fn denavit_hartenberg(manipulator: &Manipulator, row: &Row, modified: bool) -> Option<[f64; 4]> {
    let before = &row.before.elements;
    let turn = before.last()?;
    let twist = if modified { before.get(before.len().checked_sub(2)?)? } else { row.after.elements.last()? };
    let along = |of: &Placement, axis: usize| nominal(manipulator, &of.translation[axis]).to_f64();
    let angle = |of: &Placement, i: usize, j: usize| of.rotation[i][j].to_f64().atan2(of.rotation[j][j].to_f64());
    Some([along(twist, 0), angle(twist, 2, 1), along(turn, 2), angle(turn, 1, 0)])
}

impl View<'_> {
    /// A quantity of the description as an expression.
    pub fn polynomial(self, pool: &mut Pool, manipulator: &Manipulator, value: &Polynomial) -> ExprId {
        let number = |pool: &mut Pool, id: u32| pool.constant(&manipulator.parameters[id as usize].nominal);
        match self {
            View::Nominal => pool.constant(&nominal(manipulator, value)),
            View::Symbolic => pool.polynomial(value, &|pool, id| pool.symbol(Symbol::Parameter(id as u16))),
            View::Vector(vector) | View::VectorZero(vector) => {
                let ParameterKind::Names(names) = &vector.kind else { return pool.constant(&nominal(manipulator, value)) };
                pool.polynomial(value, &|pool, id| match names.iter().position(|name| name.0 == id) {
                    Some(column) if matches!(self, View::Vector(_)) => pool.symbol(Symbol::Parameter(column as u16)),
                    Some(_) => ExprId::ZERO,
                    None => number(pool, id),
                })
            }
        }
    }

    /// Whether the ten parameters of a link are those in its joint frame, with the payload among them.
    pub fn bodies_in_joint_frames(self) -> bool {
        matches!(self, View::Vector(ParameterVector { kind: ParameterKind::Base(_), .. }))
    }

    /// A standard parameter as an expression.
    pub fn standard(self, pool: &mut Pool, manipulator: &Manipulator, parameter: StandardParameter) -> ExprId {
        match self {
            View::Nominal => pool.constant(&parameter.nominal(manipulator)),
            View::Vector(vector) | View::VectorZero(vector) if !matches!(vector.kind, ParameterKind::Names(_)) => {
                match vector.position(parameter) {
                    Some(column) if matches!(self, View::Vector(_)) => pool.symbol(Symbol::Parameter(column as u16)),
                    _ => ExprId::ZERO,
                }
            }
            View::Symbolic | View::Vector(_) | View::VectorZero(_) => self.in_names(pool, manipulator, parameter),
        }
    }

    /// A standard parameter as an expression in the names of the description.
    fn in_names(self, pool: &mut Pool, manipulator: &Manipulator, parameter: StandardParameter) -> ExprId {
        match parameter.entry(manipulator) {
            Entry::Whole(value) => value.map_or(ExprId::ZERO, |value| self.polynomial(pool, manipulator, value)),
            Entry::OfBodies(bodies, k) => bodies.iter().fold(ExprId::ZERO, |sum, part| {
                let of = self.of_body(pool, manipulator, &part.body, k);
                pool.add(sum, of)
            }),
        }
    }

    /// An inertial parameter of one body as an expression in the names of the description.
    fn of_body(self, pool: &mut Pool, manipulator: &Manipulator, body: &Body, k: Inertial) -> ExprId {
        if stays_short(body) {
            let value = inertial(body, k, &mut Polynomial::clone, &mut |a, b| a * b, &mut |a, b| a + b, &mut |a| -a);
            return self.polynomial(pool, manipulator, &value);
        }
        let pool = RefCell::new(pool);
        let mut entry = |value: &Polynomial| self.polynomial(&mut pool.borrow_mut(), manipulator, value);
        let mut mul = |a: &ExprId, b: &ExprId| pool.borrow_mut().mul(*a, *b);
        inertial(body, k, &mut entry, &mut mul, &mut |a, b| pool.borrow_mut().add(*a, *b), &mut |a| -*a)
    }
}

impl ParameterVector {
    /// Names of the description.
    pub fn named(manipulator: &Manipulator, names: &[ParameterId]) -> ParameterVector {
        let entries = names
            .iter()
            .map(|id| {
                let parameter = &manipulator.parameters[id.0 as usize];
                Parameter {
                    name: parameter.name.clone(),
                    nominal: parameter.nominal.clone(),
                    meaning: format!("parameter of the description, {}", parameter.nominal.to_f64()),
                }
            })
            .collect();
        ParameterVector { entries, kind: ParameterKind::Names(names.to_vec()) }
    }

    /// All standard parameters.
    pub fn standard(manipulator: &Manipulator) -> ParameterVector {
        let columns = StandardParameter::all(manipulator);
        let entries = columns
            .iter()
            .map(|&p| Parameter {
                name: p.full_name(manipulator),
                nominal: p.nominal(manipulator),
                meaning: p.meaning(manipulator),
            })
            .collect();
        ParameterVector { entries, kind: ParameterKind::Standard(columns) }
    }

    /// The column of a standard parameter.
    pub fn position(&self, parameter: StandardParameter) -> Option<usize> {
        match &self.kind {
            ParameterKind::Standard(columns) | ParameterKind::Base(columns) => columns.iter().position(|&c| c == parameter),
            ParameterKind::Names(_) => None,
        }
    }

    /// Number of entries.
    pub fn len(&self) -> usize {
        self.entries.len()
    }

    /// Whether there are no entries.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }
}

impl StandardParameter {
    /// Its meaning, with unit and frame.
    pub fn meaning(self, manipulator: &Manipulator) -> String {
        let name = |i: u16| &manipulator.joints[usize::from(i)].name;
        match self {
            StandardParameter::Link(i, k) => format!("link {} ({}): {}", i + 1, name(i), k.meaning()),
            StandardParameter::RotorInertia(i) => {
                format!("rotor of joint {} ({}): inertia about its axis, kg m²", i + 1, name(i))
            }
            StandardParameter::Armature(i) => {
                format!("joint {} ({}): armature, added to its own entry of the inertia matrix, kg m² or kg", i + 1, name(i))
            }
            StandardParameter::RotorViscous(i) => {
                format!("rotor of joint {} ({}): viscous friction at the rotor, N m s", i + 1, name(i))
            }
            StandardParameter::Viscous(i) => format!("joint {} ({}): viscous friction, N m s or N s/m", i + 1, name(i)),
            StandardParameter::Coulomb(i) => format!("joint {} ({}): Coulomb friction, N m or N", i + 1, name(i)),
            StandardParameter::Offset(i) => format!("joint {} ({}): friction whatever the rate, N m or N", i + 1, name(i)),
            StandardParameter::Cubic(i) => format!("joint {} ({}): cubic friction, N m s³ or N s³/m³", i + 1, name(i)),
            StandardParameter::Stribeck(i) => {
                format!("joint {} ({}): Stribeck friction at the lowest rates, N m or N", i + 1, name(i))
            }
            StandardParameter::Stiffness(i) => format!("joint {} ({}): stiffness of its spring, N m/rad or N/m", i + 1, name(i)),
            StandardParameter::Payload(number, k) => match manipulator.loads()[usize::from(number)].of {
                Some(tip) => format!("payload of {tip}, in its frame: {}", k.meaning()),
                None => format!("payload, in the end-effector frame: {}", k.meaning()),
            },
        }
    }
}

/// Second moments ∫ r r' dm (xx xy yy xz yz zz) from an inertia tensor: ½ tr(I) 1 - I.
pub fn second_moments(pool: &mut Pool, inertia: &[ExprId; 6]) -> [ExprId; 6] {
    let [xx, xy, yy, xz, yz, zz] = *inertia;
    let half = pool.constant(&Number::from(Rational::from_parts(1.into(), 2u8.into())));
    let mut diagonal = |plus: [ExprId; 2], minus: ExprId| {
        let sum = pool.add(plus[0], plus[1]);
        let twice = pool.sub(sum, minus);
        pool.mul(half, twice)
    };
    [diagonal([yy, zz], xx), -xy, diagonal([xx, zz], yy), -xz, -yz, diagonal([xx, yy], zz)]
}
