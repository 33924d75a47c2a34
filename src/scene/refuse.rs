//! Refuses by name what is not available yet, so that no scene seems to do what it does not.

use crate::scene::raw::Scene;
use crate::scene::report::{Place, Report};
use crate::scene::tree::Field;
use crate::scene::values::Tables;

/// Reports every stage that `scene` asks for and that is not available yet.
pub fn refuse(scene: &Scene, report: &mut Report) {
    refuse_tables(&scene.drag, "[[drag]]", report);
    if let Some(discrete) = scene.discrete.given()
        && discrete.value.enabled.value() != Some(&false)
    {
        let help = "remove the table, or set enabled = false";
        refuse_one(&discrete.place, "[discrete]", help, report);
    }
    if let Some(physics) = scene.physics.given()
        && physics.value.touch_up.value() != Some(&false)
    {
        let help = "remove the table, or set touch_up = false";
        refuse_one(&physics.place, "[physics]", help, report);
    }
}

fn refuse_tables<T>(tables: &Field<Tables<T>>, what: &str, report: &mut Report) {
    let tables = tables.tables();
    if let Some(first) = tables.first() {
        let help = match tables.len() {
            1 => "remove this table".to_owned(),
            count => format!("remove all {count} tables of this kind"),
        };
        refuse_one(&first.place, what, &help, report);
    }
}

fn refuse_one(place: &Place, what: &str, help: &str, report: &mut Report) {
    report.fault(place, format!("{what} is not available yet"), help);
}
