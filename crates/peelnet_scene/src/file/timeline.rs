//! `[[timeline]]`: the states of a scene that changes over time, and its objects at one time.

use super::{
    loader::Loader,
    raw::{RawMaterial, RawObject, RawScene},
    references::MeshRef,
};
use crate::{error::SceneError, material::Material};
use peelnet_files::printable;
use std::collections::HashMap;

pub(super) const NO_TIMELINE: &str = "is missing: leave the time out, or add [[timeline]] states";

/// The objects of a scene at one time of its timeline.
pub(super) struct Snapshot {
    pub time: f32,
    /// By name of the object: the changes that are in force, and those that are at the next state's time.
    pub changes: HashMap<String, [Changed; 2]>,
    /// How far the time is on its way to the next state, 0 … 1.
    pub share: f32,
}

/// All changes of an object up to a state.
#[derive(Clone, Default)]
pub(super) struct Changed {
    pub mesh: Option<MeshRef>,
    pub material: RawMaterial,
}

impl Snapshot {
    /// Checks all states, and takes the snapshot at a time, the first state's if there is none.
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
        check(loader, raw)?;
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

/// Checks all states, whichever is shown.
fn check(loader: &mut Loader<'_>, raw: &RawScene) -> Result<(), SceneError> {
    let states = &raw.timeline;
    let mut objects: HashMap<&str, &RawObject> = HashMap::new();
    for object in &raw.object {
        if let Some(name) = &object.name {
            objects.entry(name).or_insert(object);
        }
    }
    for (i, state) in states.iter().enumerate() {
        let field = format!("timeline {}", i + 1);
        let is_later = i == 0 || states[i - 1].time < state.time;
        if !(state.time.is_finite() && is_later) {
            return Err(loader.value(
                &format!("{field}.time"),
                "must be finite and later than the state before it",
            ));
        }
        for change in &state.object {
            let Some(object) = objects.get(change.name.as_str()) else {
                let message = format!("no [[object]] is named '{}'", printable(&change.name));
                return Err(loader.value(&format!("{field}.object.name"), message));
            };
            let any = Material::default_with(loader.lighting);
            let material = change.material.after(&object.material);
            loader.material(&any, &material, false, &format!("{field}, {}", change.name))?;
        }
    }
    Ok(())
}
