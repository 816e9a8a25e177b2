//! Columns of the regressor, by linearity: the torque of a unit parameter.

use super::{Description, Matrix, Model, RegressorChoice};

/// tau = Y pi + tau_known at one state.
#[derive(Clone, Debug)]
pub struct Regressor {
    /// Y, n x p.
    pub y: Matrix,
    /// Nominal parameters, p.
    pub parameters: Vec<f64>,
    /// Torque of all terms that are not in pi.
    pub known: Vec<f64>,
}

impl Description {
    /// The regressor that the file asks for, at (q, dq, dqr, ddqr); `None` for `base`, whose parameters are the generator's choice.
    ///
    /// Errors: a name of the list is no parameter.
    pub fn regressor(&self, q: &[f64], dq: &[f64], dqr: &[f64], ddqr: &[f64]) -> Option<Result<Regressor, String>> {
        let torque = |model: &Model| model.inverse_dynamics_4(q, dq, dqr, ddqr);
        Some(match self.regressor_choice() {
            RegressorChoice::Base => return None,
            RegressorChoice::Standard => self.model().map(|model| model.standard_regressor(q, dq, dqr, ddqr)),
            RegressorChoice::Names(names) => (|| {
                let nominal = self.nominal()?;
                let value = |name: &String| nominal.get(name).copied().ok_or_else(|| format!("`{name}` is no parameter"));
                let parameters = names.iter().map(value).collect::<Result<Vec<f64>, _>>()?;
                let unit = |k: Option<usize>| -> Vec<(&str, f64)> {
                    names.iter().enumerate().map(|(i, name)| (name.as_str(), f64::from(u8::from(k == Some(i))))).collect()
                };
                let known = torque(&self.model_with(&unit(None))?);
                let columns = (0..names.len())
                    .map(|k| Ok(torque(&self.model_with(&unit(Some(k)))?)))
                    .collect::<Result<Matrix, String>>()?;
                Ok(Regressor::new(columns, parameters, known))
            })(),
        })
    }
}

impl Regressor {
    fn new(columns: Matrix, parameters: Vec<f64>, known: Vec<f64>) -> Self {
        let y = (0..known.len()).map(|i| columns.iter().map(|column| column[i] - known[i]).collect()).collect();
        Regressor { y, parameters, known }
    }

    /// Y pi + tau_known.
    pub fn torque(&self) -> Vec<f64> {
        super::times(&self.y, &self.parameters).iter().zip(&self.known).map(|(a, b)| a + b).collect()
    }
}

impl Model {
    /// The places of the standard parameters. Each link has ten. Each joint follows with the given ones of rotor inertia, rotor and joint
    /// viscous friction, Coulomb friction, offset, cubic and Stribeck friction, and spring stiffness. The payload's ten come last.
    fn standard_places(&mut self) -> Vec<&mut f64> {
        let (mut links, mut drives) = (Vec::new(), Vec::new());
        for joint in &mut self.joints {
            links.extend(&mut joint.link);
            let motor = joint.motor.as_mut().map(|motor| (motor.inertia.as_mut(), motor.viscous.as_mut()));
            let (inertia, viscous) = motor.unwrap_or_default();
            drives.extend([inertia, joint.armature.as_mut(), viscous].into_iter().flatten());
            drives.extend(joint.viscous.as_mut());
            drives.extend([joint.coulomb.as_mut(), joint.offset.as_mut(), joint.cubic.as_mut()].into_iter().flatten());
            drives.extend(joint.stribeck.as_mut());
            drives.extend(joint.stiffness.as_mut());
        }
        links.extend(drives);
        links.extend(self.payload.iter_mut().flatten());
        links
    }

    /// The standard parameters of this arm, in order.
    pub fn standard_parameters(&self) -> Vec<f64> {
        self.clone().standard_places().into_iter().map(|x| *x).collect()
    }

    /// This arm with other standard parameters.
    ///
    /// Panics where their number differs.
    pub fn with_standard_parameters(&self, parameters: &[f64]) -> Model {
        let mut model = self.clone();
        let places = model.standard_places();
        assert_eq!(places.len(), parameters.len());
        places.into_iter().zip(parameters).for_each(|(place, &x)| *place = x);
        model
    }

    /// The regressor of the standard parameters at (q, dq, dqr, ddqr).
    pub fn standard_regressor(&self, q: &[f64], dq: &[f64], dqr: &[f64], ddqr: &[f64]) -> Regressor {
        let parameters = self.standard_parameters();
        let torque = |pi: &[f64]| self.with_standard_parameters(pi).inverse_dynamics_4(q, dq, dqr, ddqr);
        let mut unit = vec![0.0; parameters.len()];
        let known = torque(&unit);
        let columns = (0..unit.len())
            .map(|k| {
                unit[k] = 1.0;
                let column = torque(&unit);
                unit[k] = 0.0;
                column
            })
            .collect();
        Regressor::new(columns, parameters, known)
    }
}
