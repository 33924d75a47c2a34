//! Refuses by name what is not available yet, so that no scene seems to do what it does not.

use crate::scene::raw::Scene;
use crate::scene::report::{Place, Report};

/// Reports every stage that `scene` asks for and that is not available yet.
pub fn refuse(scene: &Scene, report: &mut Report) {
    if let Some(physics) = scene.physics.given()
        && physics.value.touch_up.value() != Some(&false)
    {
        let help = "remove the table, or set touch_up = false";
        refuse_one(&physics.place, "[physics]", help, report);
    }
}

fn refuse_one(place: &Place, what: &str, help: &str, report: &mut Report) {
    report.fault(place, format!("{what} is not available yet"), help);
}
