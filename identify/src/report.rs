//! What an identification found: as JSON, and as tables of words for a terminal.

use serde_json::{json, Value};

use crate::arm::Arm;
use crate::finding::Findings;
use crate::identify::{Identified, Input, Interval};
use crate::judge::Judgement;
use crate::written::Written;

fn number(x: f64) -> Value {
    if x.is_finite() {
        json!(x)
    } else {
        Value::Null
    }
}

fn numbers(x: &[f64]) -> Value {
    Value::Array(x.iter().map(|x| number(*x)).collect())
}

fn interval(of: &Interval) -> Value {
    json!({"value": number(of.value), "sigma": number(of.sigma), "low": number(of.low), "high": number(of.high)})
}

fn with(mut object: Value, more: Value) -> Value {
    if let (Value::Object(object), Value::Object(more)) = (&mut object, more) {
        object.extend(more);
    }
    object
}

/// A judgement as JSON.
pub fn judgement(arm: &Arm, file: &str, of: &Judgement) -> Value {
    let contacts: Vec<Value> = of
        .contacts
        .iter()
        .map(|contact| {
            let joints: Vec<&str> = contact.joints.iter().map(|&j| arm.joints[j].name.as_str()).collect();
            json!({"from": number(contact.from), "to": number(contact.to), "joints": joints})
        })
        .collect();
    json!({
        "file": file,
        "rms": numbers(&of.rms),
        "relative": numbers(&of.relative),
        "moving": numbers(&of.moving),
        "delay": numbers(&of.delays),
        "contacts": contacts,
    })
}

/// Findings as JSON.
pub fn findings(findings: &Findings) -> Value {
    let all = findings.iter().map(|finding| {
        json!({
            "code": finding.code.name(),
            "log": finding.log,
            "line": finding.line,
            "column": finding.column,
            "text": finding.text,
            "help": finding.help,
        })
    });
    Value::Array(all.collect())
}

/// The report of an identification: numbers over joints in the order of the description.
pub fn json(
    arm: &Arm,
    inputs: &[Input],
    found: &Identified,
    written: Option<&Written>,
    validation: &[(String, Judgement)],
    all: &Findings,
) -> Value {
    let constrained = written.map(|written| written.consistent.base(arm));
    let logs: Vec<Value> = inputs
        .iter()
        .map(|input| {
            let mut warnings: Vec<&str> =
                all.iter().filter(|finding| finding.log == input.log.name).map(|finding| finding.code.name()).collect();
            warnings.dedup();
            json!({
                "file": input.log.name,
                "sha256": input.log.digest,
                "samples": input.log.samples,
                "unused_columns": input.log.unused,
                "warnings": warnings,
            })
        })
        .collect();
    let base: Vec<Value> = arm
        .base
        .iter()
        .zip(&found.base)
        .enumerate()
        .map(|(k, (parameter, value))| {
            let own = json!({"name": parameter.name, "combination": parameter.meaning, "excited": value.excited});
            let written = constrained.as_ref().map_or_else(|| json!({}), |base| json!({"constrained": number(base[k])}));
            with(with(own, interval(value)), written)
        })
        .collect();
    let friction: Vec<Value> = found
        .friction
        .iter()
        .map(|of| {
            let own = json!({
                "joint": arm.joints[of.joint].name,
                "key": of.term.key(),
                "session": found.sessions[of.session],
                "excited": of.value.excited,
            });
            with(own, interval(&of.value))
        })
        .collect();
    let gains: Vec<Value> = found
        .gains
        .iter()
        .zip(&arm.joints)
        .map(|(value, joint)| with(json!({"joint": joint.name, "identified": value.excited}), interval(value)))
        .collect();
    let delay = |(of, joint): (&Interval, &crate::arm::Joint)| {
        with(json!({"joint": joint.name, "determined": of.excited && of.sigma > 0.0}), interval(of))
    };
    let delays: Vec<Value> = found.delays.iter().zip(&arm.joints).map(delay).collect();
    let payload: Vec<Value> = found
        .loads
        .iter()
        .map(|(log, ten)| {
            let mut of = json!({"log": inputs[*log].log.name});
            for (name, value) in crate::body::NAMES.iter().zip(ten) {
                if let (Some(value), Value::Object(of)) = (value, &mut of) {
                    of.insert((if *name == "m" { "mass" } else { name }).to_owned(), interval(value));
                }
            }
            of
        })
        .collect();
    let unexcited: Vec<Value> =
        found.unexcited.iter().map(|(names, words)| json!({"names": names, "direction": words})).collect();
    let by_log = |of: fn(&Judgement) -> &Vec<f64>| Value::Array(found.judgements.iter().map(|own| numbers(of(own))).collect());
    json!({
        "robot": arm.name,
        "samples": inputs.iter().map(|input| input.log.samples).sum::<usize>(),
        "used": found.used,
        "rate": number(found.rate),
        "cutoff": number(found.cutoff),
        "delay": found.delays.iter().map(|delay| number(delay.value)).collect::<Vec<_>>(),
        "delays": delays,
        "logs": logs,
        "residual": {
            "unit": "N m, N",
            "rms": by_log(|own| &own.rms),
            "relative": by_log(|own| &own.relative),
            "moving": by_log(|own| &own.moving),
        },
        "validation": validation.iter().map(|(file, of)| judgement(arm, file, of)).collect::<Vec<_>>(),
        "base": base,
        "friction": friction,
        "gains": gains,
        "payload": payload,
        "blocks": found.blocks,
        "excitation": {
            "condition": number(found.condition),
            "log_det_per_parameter": number(found.log_det_per_parameter),
            "unexcited": unexcited,
            "inseparable": found.inseparable,
        },
        "written": written.map(|written| {
            let of = &written.consistent;
            json!({
                "digits": written.digits,
                "changed": written.changed,
                "positive": true,
                "pivots": written.pivots.iter().map(|pivots| numbers(pivots)).collect::<Vec<_>>(),
                "objective": number(of.objective),
                "unconstrained": number(of.unconstrained),
                "mu": number(of.mu),
                "notes": written.notes,
            })
        }),
        "diagnostics": findings(all),
    })
}
