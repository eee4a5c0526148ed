//! `[[timeline]]`: the states of an ageing scene, and what they make of its objects at one time.

use super::{Loader, MeshRef, RawObject, RawScene, looks::RawMaterial};
use crate::{Material, SceneError};
use serde::Deserialize;
use std::collections::HashMap;

/// A state of an ageing scene: what changes from its time on.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawState {
    pub time: f32,
    #[serde(default)]
    pub label: String,
    #[serde(default)]
    pub object: Vec<RawChange>,
}

/// What becomes of an object.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct RawChange {
    pub name: String,
    pub mesh: Option<MeshRef>,
    #[serde(default)]
    pub material: RawMaterial,
}

pub(super) const NO_TIMELINE: &str = "is missing: leave the time out, or add [[timeline]] states";

/// What a timeline makes of objects at one time.
pub(super) struct Age {
    pub time: f32,
    /// By name of the object: how it is, and how it will be at the next state's time.
    pub changes: HashMap<String, [Changed; 2]>,
    /// How far it is to the next state, 0 … 1.
    pub share: f32,
}

/// An object as the states so far have left it.
#[derive(Clone, Default)]
pub(super) struct Changed {
    pub mesh: Option<MeshRef>,
    pub material: RawMaterial,
}

impl Age {
    pub fn of(
        loader: &mut Loader<'_>,
        raw: &RawScene,
        time: Option<f32>,
    ) -> Result<Self, SceneError> {
        let states = &raw.timeline;
        let (Some(first), Some(last)) = (states.first(), states.last()) else {
            return match time {
                None => Ok(Self {
                    time: 0.0,
                    changes: HashMap::new(),
                    share: 0.0,
                }),
                Some(_) => Err(loader.value("timeline", NO_TIMELINE)),
            };
        };
        for (i, state) in states.iter().enumerate() {
            let field = format!("timeline {}", i + 1);
            let later = i == 0 || states[i - 1].time < state.time;
            if !(state.time.is_finite() && later) {
                return Err(loader.value(
                    &format!("{field}.time"),
                    "must be finite and later than the state before it",
                ));
            }
            for change in &state.object {
                let of_name = |o: &&RawObject| o.name.as_ref() == Some(&change.name);
                let Some(object) = raw.object.iter().find(of_name) else {
                    let message = format!("no [[object]] is named '{}'", change.name);
                    return Err(loader.value(&format!("{field}.object.name"), message));
                };
                // All states are checked, whichever is shown.
                let any = Material::default_with(loader.lighting);
                let place = format!("{field}, {}", change.name);
                let looks = change.material.after(&object.material);
                loader.material(&any, &looks, false, &place)?;
            }
        }
        let time = time.unwrap_or(first.time);
        if !(first.time..=last.time).contains(&time) {
            return Err(loader.value(
                "timeline",
                format!("runs from {} to {}, not to {time}", first.time, last.time),
            ));
        }
        let shown = states.iter().rposition(|s| s.time <= time).unwrap_or(0);
        let mut changes: HashMap<String, [Changed; 2]> = HashMap::new();
        for (i, state) in states.iter().enumerate().take(shown + 2) {
            for change in &state.object {
                let both = changes.entry(change.name.clone()).or_default();
                let next = both[1].clone();
                let changed = Changed {
                    mesh: change.mesh.clone().or(next.mesh),
                    material: change.material.after(&next.material),
                };
                if i <= shown {
                    both[0] = changed.clone();
                }
                both[1] = changed;
            }
        }
        let next = states.get(shown + 1).map_or(f32::INFINITY, |s| s.time);
        let share = (time - states[shown].time) / (next - states[shown].time);
        Ok(Self {
            time,
            changes,
            share,
        })
    }
}
