//! What a scene lets discrete editing do: its table checked.

use crate::constraint::{ChangeKind, Discrete, Evaluator, Moment};
use crate::geometry::c64;
use crate::index::CharacterId;
use crate::scene::checker::{Checker, plan_point};
use crate::scene::manipulation;
use crate::scene::report::At;
use crate::scene::suggest;
use crate::scene::tree::Field;
use crate::scene::values::{self, Pair};

impl Checker<'_> {
    /// Checks the `[discrete]` table.
    pub fn discrete(&mut self, table: &Field<manipulation::Discrete>) {
        let Some(raw) = table.value().filter(|raw| raw.enabled.value() != Some(&false)) else { return };
        let default = Discrete::default();
        let kinds = raw.kinds.value().map(|kinds| kinds.iter().map(|kind| change(kind.value)).collect());
        if let Some(given) = raw.kinds.given().filter(|given| given.value.is_empty()) {
            self.report.fault(
                &given.place,
                "no kind of change is left",
                "name one, or write enabled = false",
            );
        }
        let characters =
            raw.characters.value().map(|names| names.iter().filter_map(|name| self.member(name)).collect());
        let times =
            raw.times.value().map(|times| times.iter().filter_map(|pair| self.window(pair)).collect());
        let regions =
            raw.regions.value().map(|regions| regions.iter().map(|region| self.region(region)).collect());
        self.checked.discrete = Some(Discrete {
            kinds: kinds.unwrap_or(default.kinds),
            characters,
            times,
            regions,
            evaluator: match raw.evaluator.value() {
                Some(values::Evaluator::BruteForce) => Evaluator::BruteForce,
                Some(values::Evaluator::Subsampled) => Evaluator::Subsampled,
                Some(values::Evaluator::Exact) | None => Evaluator::Exact,
            },
            settle: raw.settle.value().copied().unwrap_or(default.settle),
            reversible: raw.reversible.value().copied().unwrap_or(default.reversible),
        });
    }

    /// The character of a name in a list of them.
    pub fn member(&mut self, name: &At<String>) -> Option<CharacterId> {
        let found = self.cast_places.get(name.value.as_str()).copied();
        if found.is_none() {
            let names: Vec<&str> = self.cast.iter().map(|member| member.name.as_str()).collect();
            let message = format!("there is no character \"{}\"", name.value);
            self.report.fault(&name.place, message, suggest::remedy(&name.value, "characters", &names));
        }
        found.map(CharacterId::from_usize)
    }

    fn window(&mut self, pair: &At<Pair<String>>) -> Option<(Moment, Moment)> {
        self.interval(&pair.value, &pair.place)
    }

    fn region(&mut self, region: &At<Pair<Pair<f64>>>) -> (c64, c64) {
        let [a, b] = region.value.each_ref().map(|corner| plan_point(corner, self.report));
        (c64::new(a.re.min(b.re), a.im.min(b.im)), c64::new(a.re.max(b.re), a.im.max(b.im)))
    }
}

fn change(kind: values::ChangeKind) -> ChangeKind {
    match kind {
        values::ChangeKind::Delete => ChangeKind::Delete,
        values::ChangeKind::Duplicate => ChangeKind::Duplicate,
        values::ChangeKind::Insert => ChangeKind::Insert,
        values::ChangeKind::Replace => ChangeKind::Replace,
    }
}
