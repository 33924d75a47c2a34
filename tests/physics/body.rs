//! Bodies with masses.

use std::collections::BTreeMap;
use std::sync::Arc;

use cotillion::clip::builtin::generate;
use cotillion::physics::body_model::shape::{Shape, principal_moments, radius_of_cylinder};
use cotillion::physics::body_model::{
    BodyError, BodySettings, MassTable, REFERENCE_MASS, Segment, body_model,
};
use cotillion::skeleton::Skeleton;
use glam::DVec3;

/// Fractions are decimals.
const ROUNDING: f64 = 1e-12;

fn skeleton() -> Arc<Skeleton> {
    generate("walk", &BTreeMap::new()).expect("a generated clip").skeleton
}

#[test]
fn segments_are_the_whole_body() {
    let total: f64 = Segment::ALL.iter().map(|own| own.count() as f64 * own.fraction()).sum();
    assert!((total - 1.0).abs() < ROUNDING);
    let printed: f64 = Segment::ALL.iter().map(|own| own.count() as f64 * own.xiao_mass()).sum();
    assert!((printed - 76.423).abs() < 1e-9, "{printed}");
}

#[test]
fn printed_masses_are_the_fractions_of_75_kg_but_for_the_thorax() {
    for own in Segment::ALL {
        let (by_fraction, printed) = (own.fraction() * REFERENCE_MASS, own.xiao_mass());
        if own == Segment::Thorax {
            assert!((by_fraction - 16.2).abs() < ROUNDING && printed == 17.625);
        } else {
            // Three decimals are printed, cut off.
            assert!((by_fraction - printed).abs() < 1e-3, "{own:?}");
        }
    }
}

/// Radius, moments about the bone and across it.
const CYLINDERS: [(Segment, [f64; 3]); 5] = [
    (Segment::Thigh, [0.071_80, 0.019_334, 0.131_217]),
    (Segment::Shank, [0.049_24, 0.004_227, 0.053_372]),
    (Segment::UpperArm, [0.043_18, 0.001_958, 0.020_618]),
    (Segment::Forearm, [0.035_85, 0.000_771, 0.007_302]),
    (Segment::Head, [0.073_78, 0.016_536, 0.060_108]),
];

/// Depth, moments about the lateral axis, the vertical one and the one ahead.
const BOXES: [(Segment, [f64; 4]); 3] = [
    (Segment::Pelvis, [0.174_87, 0.055_894, 0.126_738, 0.128_355]),
    (Segment::Abdomen, [0.191_14, 0.059_888, 0.109_928, 0.106_335]),
    (Segment::Thorax, [0.153_23, 0.185_925, 0.187_755, 0.310_289]),
];

#[test]
fn links_have_the_stated_sizes_and_moments() {
    // One unit of the last stated digit: masses were stated to three.
    let (size, moment) = (1.1e-5, 2e-6);
    for (own, [radius, along, across]) in CYLINDERS {
        // The stated ones are of the printed masses.
        let mass = own.xiao_mass();
        let found = principal_moments(own.reference_shape(), mass, own.density());
        assert!(
            (radius_of_cylinder(mass, own.density(), own.xiao_length()) - radius).abs() < size,
            "{own:?}"
        );
        assert!((found - DVec3::new(across, along, across)).abs().max_element() < moment, "{own:?} {found}");
    }
    for (own, [depth, lateral, vertical, ahead]) in BOXES {
        let mass = own.fraction() * REFERENCE_MASS;
        let shape = own.reference_shape();
        let Shape::Box { depth: found_depth, .. } = shape else { panic!("{own:?} is a box") };
        let found = principal_moments(shape, mass, own.density());
        assert!((found_depth - depth).abs() < size, "{own:?} {found_depth}");
        assert!(
            (found - DVec3::new(lateral, vertical, ahead)).abs().max_element() < moment,
            "{own:?} {found}"
        );
    }
}

#[test]
fn the_generated_body_weighs_what_is_asked_by_segment() {
    let body = body_model(&skeleton(), &BodySettings::default()).expect("a whole body");
    assert!((body.mass - 75.0).abs() < ROUNDING * 100.0);
    for (own, mass) in Segment::ALL.iter().zip(body.segment_masses()) {
        let expected = own.count() as f64 * own.fraction() * 75.0;
        assert!((mass - expected).abs() < 1e-9, "{own:?}");
    }
    // Its legs are 0.82 m.
    assert!((body.stature - 0.82 / 0.491).abs() < 1e-9);
}

#[test]
fn the_printed_table_weighs_more() {
    let settings = BodySettings { table: MassTable::Xiao2005, mass: 75.0 };
    let body = body_model(&skeleton(), &settings).expect("a whole body");
    assert!((body.mass - 76.423).abs() < 1e-9, "{}", body.mass);
}

#[test]
fn inertia_is_positive_and_symmetric_and_grows_with_mass() {
    let body = body_model(&skeleton(), &BodySettings::default()).expect("a whole body");
    for link in &body.links {
        let inertia = link.inertia;
        assert!((inertia - inertia.transpose()).abs_diff_eq(glam::DMat3::ZERO, 1e-12));
        for axis in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::ONE] {
            assert!(axis.dot(inertia * axis) > 0.0, "{:?}", link.segment);
        }
    }
    let doubled: Vec<f64> = body.links.iter().map(|link| 2.0 * link.mass).collect();
    let heavy = body.with_link_masses(&doubled);
    assert!((heavy.mass - 150.0).abs() < 1e-9);
    assert!(heavy.links[0].inertia.abs_diff_eq(body.links[0].inertia * 2.0, 1e-12));
}

/// Names that tell nothing, and no roles.
fn nameless() -> Skeleton {
    let mut skeleton = (*skeleton()).clone();
    for (index, joint) in skeleton.joints.iter_mut().enumerate() {
        joint.name = format!("j{index}");
        joint.role = None;
    }
    skeleton
}

#[test]
fn the_tree_tells_limbs_where_names_tell_nothing() {
    let named = body_model(&skeleton(), &BodySettings::default()).expect("a whole body");
    let found = body_model(&nameless(), &BodySettings::default()).expect("its tree is whole");
    assert_eq!(found.stature, named.stature);
    let (a, b) = (found.segment_masses(), named.segment_masses());
    for (index, own) in Segment::ALL.iter().enumerate() {
        assert!((a[index] - b[index]).abs() < 1e-9, "{own:?}: {} {}", a[index], b[index]);
    }
}

#[test]
fn a_skeleton_without_a_leg_is_refused_with_its_joints() {
    let mut skeleton = nameless();
    skeleton.joints.truncate(13);
    match body_model(&skeleton, &BodySettings::default()) {
        Err(BodyError::NoLeg { joints, .. }) => assert!(joints.len() == 13 && joints[4] == "j4"),
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_stray_hand_counts_as_one_of_usual_length() {
    let mut skeleton = (*skeleton()).clone();
    let hand = skeleton.joint_of(cotillion::skeleton::JointRole::RightHand).expect("a hand");
    skeleton.joints[hand.as_usize()].end_site = Some(DVec3::X * 1.6);
    let body = body_model(&skeleton, &BodySettings::default()).expect("a whole body");
    let link = body.links.iter().find(|link| link.joint == hand).expect("hands have mass");
    assert!((link.com.length() - 0.506 * 0.108 * body.stature).abs() < 1e-9, "{}", link.com);
}

#[test]
fn a_body_of_no_mass_is_refused() {
    for mass in [0.0, -3.0, f64::NAN, f64::INFINITY] {
        let settings = BodySettings { mass, ..BodySettings::default() };
        assert!(matches!(body_model(&skeleton(), &settings), Err(BodyError::NoMass { .. })));
    }
}
