//! Drags of a scene: each table checked, its handle found; then bound to constraints, those that are missing added.

use crate::clip::working::WORKING_STEP;
use crate::constraint::{Constraint, ConstraintKind, Drag, Moment, Relation, Strength, Target, When};
use crate::geometry::plan_of;
use crate::index::ConstraintId;
use crate::scene::Character;
use crate::scene::checker::{Checked, Checker, plan_point, seconds_within};
use crate::scene::manipulation;
use crate::scene::report::{At, Place};
use crate::scene::suggest;

/// Steps of a drag that does not say how many.
const STEPS: u32 = 20;
/// More steps than this take hours.
const MOST_STEPS: u32 = 100_000;

/// A drag whose handle is known but not yet bound to constraints.
#[derive(Clone, Debug)]
pub struct DraftDrag {
    handle: String,
    on: Handle,
    targets: Vec<Target>,
    steps: usize,
    line: u32,
}

#[derive(Clone, Debug)]
enum Handle {
    Moment(Moment),
    /// Position in [`Checked::constraints`].
    Constraint(usize),
}

impl DraftDrag {
    /// The moment that is pulled, if it is one.
    pub fn moment(&self) -> Option<&Moment> {
        match &self.on {
            Handle::Moment(moment) => Some(moment),
            Handle::Constraint(_) => None,
        }
    }
}

impl Checker<'_> {
    /// Checks one `[[drag]]`.
    pub fn drag(&mut self, table: &At<manipulation::Drag>) {
        let raw = &table.value;
        let targets = self.targets(raw, &table.place);
        let steps = raw.steps.value().copied().unwrap_or(STEPS);
        if let Some(given) = raw.steps.given().filter(|_| !(1..=MOST_STEPS).contains(&steps)) {
            let message = format!("{steps} steps");
            self.report.fault(&given.place, message, format!("write a number from 1 to {MOST_STEPS}"));
        }
        let Some(handle) = raw.handle.given() else { return };
        let named = self.checked.constraints.iter().position(|known| known.name == handle.value);
        let on = match named {
            Some(index) => self.fits(index, &targets, &handle.place).then_some(Handle::Constraint(index)),
            None if handle.value.contains(':') => self.pulled(handle, &targets),
            None => {
                self.unknown_handle(handle);
                None
            }
        };
        let line = u32::try_from(self.lines.position(table.place.span.start).0).unwrap_or(u32::MAX);
        let steps = usize::try_from(steps).unwrap_or(1).max(1);
        let draft = on.map(|on| DraftDrag { handle: handle.value.clone(), on, targets, steps, line });
        self.checked.drags.extend(draft);
    }

    /// Where the drag goes.
    fn targets(&mut self, raw: &manipulation::Drag, table: &Place) -> Vec<Target> {
        let mut targets = Vec::new();
        targets.extend(raw.to.given().map(|pair| Target::Position(plan_point(pair, self.report))));
        targets.extend(raw.offset.given().map(|pair| Target::Offset(plan_point(pair, self.report))));
        targets.extend(raw.facing.value().map(|degrees| Target::Facing(degrees.to_radians())));
        targets.extend(seconds_within(&raw.seconds, self.report).map(Target::Seconds));
        let said =
            [raw.to.is_absent(), raw.offset.is_absent(), raw.facing.is_absent(), raw.seconds.is_absent()];
        if said.iter().all(|absent| *absent) {
            let help = "add to = [x, -z], facing in degrees, seconds, or offset = [ahead, left]";
            self.report.fault(table, "the drag goes nowhere", help);
        }
        targets
    }

    fn pulled(&mut self, handle: &At<String>, targets: &[Target]) -> Option<Handle> {
        if targets.iter().any(|target| matches!(target, Target::Offset(_))) {
            let help = "give the [[relative]] a name, and write that as the handle";
            self.report.fault(&handle.place, "a moment has no offset to be dragged", help);
            return None;
        }
        self.moment(&handle.value, &handle.place).map(Handle::Moment)
    }

    fn unknown_handle(&mut self, handle: &At<String>) {
        let names: Vec<&str> = self.checked.constraints.iter().map(|known| known.name.as_str()).collect();
        let message = format!("\"{}\" is neither a moment nor a constraint", handle.value);
        let help = format!(
            "{}; a moment reads \"CHARACTER:end\" or \"CHARACTER/CLIP:EVENT\"",
            suggest::remedy(&handle.value, "constraints", &names)
        );
        self.report.fault(&handle.place, message, help);
    }

    /// Whether the constraint at `index` holds all that is dragged; otherwise that is reported.
    fn fits(&mut self, index: usize, targets: &[Target], place: &Place) -> bool {
        let constraint = &self.checked.constraints[index];
        let Some(missing) = targets.iter().find(|target| !holds(&constraint.kind, **target)) else {
            return true;
        };
        let message = format!("\"{}\" holds no {} that could be dragged", constraint.name, missing.name());
        let help = match &constraint.kind {
            ConstraintKind::Relative { .. } => {
                "write its offset (or facing) as numbers: the drag starts there"
            }
            ConstraintKind::Pin { .. } => "drag \"to\" a point or to a \"facing\", whichever the pin has",
            _ => "drag it to \"seconds\"; a sync of more than two moments cannot be dragged",
        };
        self.report.fault(place, message, help);
        false
    }
}

/// Whether a constraint has a number that `target` moves.
fn holds(kind: &ConstraintKind, target: Target) -> bool {
    match (kind, target) {
        (ConstraintKind::Pin { position, .. }, Target::Position(_)) => position.is_some(),
        (ConstraintKind::Pin { facing, .. }, Target::Facing(_)) => facing.is_some(),
        (ConstraintKind::Relative { offset, .. }, Target::Offset(_)) => matches!(offset, Relation::Given(_)),
        (ConstraintKind::Relative { facing, .. }, Target::Facing(_)) => matches!(facing, Relation::Given(_)),
        (ConstraintKind::Sync { moments, .. }, Target::Seconds(_)) => moments.len() == 2,
        (ConstraintKind::Time { .. } | ConstraintKind::Duration { .. }, Target::Seconds(_)) => true,
        _ => false,
    }
}

/// Binds drags to the constraints they move; where a moment has no pin (or time), one as at rest is added. `count`: of the
/// cast; where somebody is at fault, nothing is bound.
pub fn bind(checked: &mut Checked, characters: &[Character], count: usize) -> Vec<Drag> {
    if characters.len() != count {
        return Vec::new();
    }
    let drafts = std::mem::take(&mut checked.drags);
    drafts.into_iter().enumerate().map(|(index, draft)| bound(checked, characters, draft, index)).collect()
}

fn bound(checked: &mut Checked, characters: &[Character], draft: DraftDrag, index: usize) -> Drag {
    let DraftDrag { handle, on, targets, steps, line } = draft;
    let place = |target: Target, checked: &mut Checked| match &on {
        Handle::Constraint(constraint) => (ConstraintId::from_usize(*constraint), target),
        Handle::Moment(moment) => {
            let known =
                checked.constraints.iter().position(|known| is_at(&known.kind, moment, target, characters));
            let constraint = known.unwrap_or_else(|| {
                let name = format!("drag[{index}].{}", target.name());
                let kind = at_rest(moment, target, characters);
                checked.constraints.push(Constraint { name, line, strength: Strength::default(), kind });
                checked.constraints.len() - 1
            });
            (ConstraintId::from_usize(constraint), target)
        }
    };
    let targets = targets.into_iter().map(|target| place(target, checked)).collect();
    Drag { handle, targets, steps }
}

/// Whether a constraint holds at `moment` what `target` moves.
fn is_at(kind: &ConstraintKind, moment: &Moment, target: Target, characters: &[Character]) -> bool {
    let own = match kind {
        ConstraintKind::Pin { when: When::At(own), .. } => own,
        ConstraintKind::Time { at, .. } => at,
        _ => return false,
    };
    let track = &characters[moment.character.as_usize()].track;
    let same = own.character == moment.character && track.locate(own.instant) == track.locate(moment.instant);
    same && holds(kind, target)
}

/// What holds at `moment` before the edit, of the kind that `target` moves.
fn at_rest(moment: &Moment, target: Target, characters: &[Character]) -> ConstraintKind {
    let track = &characters[moment.character.as_usize()].track;
    let frame = track.locate(moment.instant).unwrap_or_default();
    let when = When::At(moment.clone());
    match target {
        Target::Position(_) | Target::Offset(_) => {
            let position = Some(plan_of(track.pose(frame).root));
            ConstraintKind::Pin { when, position, facing: None }
        }
        Target::Facing(_) => ConstraintKind::Pin { when, position: None, facing: Some(track.heading(frame)) },
        Target::Seconds(_) => ConstraintKind::Time { at: moment.clone(), seconds: frame * WORKING_STEP },
    }
}
