//! Steps that bodies can do, and steps that would tear them.

use std::collections::BTreeMap;

use cotillion::clip::builtin::generate;
use cotillion::physics::body_model::{BodySettings, body_model};
use cotillion::physics::ground::parts::{JointMotion, Part, PartsError, link_sets};
use cotillion::skeleton::JointRole;

fn sets(
    turned: &[Part],
    carried: &[Part],
) -> Result<cotillion::physics::ground::parts::LinkSets, PartsError> {
    let clip = generate("idle", &BTreeMap::new()).expect("a generated clip");
    let body = body_model(&clip.skeleton, &BodySettings::default()).expect("generated bodies are whole");
    link_sets(&clip.skeleton, &body, turned, carried)
}

#[test]
fn the_lower_body_carries_the_upper_one() {
    let found = sets(&[Part::Lower], &[Part::Upper]).expect("a step");
    assert!(found.moves_root() && found.components.len() == 1);
    assert!(!found.motions.contains(&JointMotion::Stays) && !found.borders.is_empty());
}

#[test]
fn arms_turn_about_both_shoulders() {
    let found = sets(&[Part::Arms], &[]).expect("a step");
    assert!(!found.moves_root() && found.components.len() == 2 && found.borders.is_empty());
}

#[test]
fn forearms_can_be_carried_by_upper_arms() {
    let fore = [Part::Below(JointRole::LeftElbow), Part::Below(JointRole::RightElbow)];
    assert!(matches!(sets(&[Part::Arms], &fore), Err(PartsError::Both { .. })));
    assert!(sets(&fore, &[]).is_ok());
}

#[test]
fn bodies_are_not_torn() {
    assert!(
        matches!(sets(&[Part::Lower], &[]), Err(PartsError::Torn { .. })),
        "the upper body would stay behind"
    );
    assert!(matches!(
        sets(&[Part::Arms], &[Part::Below(JointRole::Head)]),
        Err(PartsError::NotCarried { .. })
    ));
    assert!(matches!(sets(&[], &[]), Err(PartsError::NothingTurns)));
    assert!(matches!(sets(&[Part::Lower], &[Part::Lower, Part::Upper]), Err(PartsError::Both { .. })));
}
