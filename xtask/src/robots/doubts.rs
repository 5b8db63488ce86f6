//! What the descriptions' remarks say to somebody who uses the robot, in plain words.

/// What a doubt is about: a variant of the library's `DoubtAbout`.
type About = &'static str;

/// A remark that contains the first text becomes these doubts; none where it concerns nothing that is shipped.
const DOUBTS: &[(&str, &[(About, &str)])] = &[
    (
        "URDF joint_3 limits are a box on the decoupled J3",
        &[(
            "Limits",
            "The limits of joint 3 are those of the robot description, which has J3 + J2 where the pendant has J3: \
             they hold at J2 = 0. Elsewhere the true range of J3 depends on J2, so a posture near the corners of the \
             range may be out of the machine's reach.",
        )],
    ),
    (
        "the controller limits the pendant's J3 (relative to the base)",
        &[(
            "Limits",
            "The limits of joint 3 look like the pendant's and are taken as such. The controller also limits the \
             angle between joints 2 and 3, which is not in the source: a posture near the corners of the range may \
             be out of the machine's reach.",
        )],
    ),
    (
        "joint_3 limits: same remark",
        &[(
            "Limits",
            "The limits of joint 3 are those of the robot description, which has q3 + q2 where the pendant has q3: \
             they hold at q2 = 0. Elsewhere the true range of q3 depends on q2, so a posture near the corners of the \
             range may be out of the machine's reach.",
        )],
    ),
    (
        "URDF tool0 has z across the flange axis",
        &[(
            "Flange",
            "The flange axes are those of the robot description: x points out of the flange, z lies across it. On the \
             pendant z points out of the flange, so orientations differ by a quarter turn.",
        )],
    ),
    // A remark on the capsules, see `capsules`.
    ("Collision mesh", &[]),
    (
        "Dimensions look measured from CAD",
        &[(
            "Geometry",
            "The dimensions look measured from drawings of the links: they are not round, and axis 1 stands 2.8 mm \
             beside the base's z axis. Prefer kuka-kr210-r2700-2 where that is your robot.",
        )],
    ),
    (
        "Variant not stated; dimensions",
        &[(
            "Geometry",
            "The source does not state the variant, and its dimensions look measured: prefer abb-irb6640-185-280 \
             where that is your robot.",
        )],
    ),
    (
        "URDF has rpy rounded",
        &[(
            "Source",
            "The source rounds angles to six digits; they were taken as multiples of 90 deg.",
        )],
    ),
    (
        "Joint 1 limit +-90 deg is likely the cell's",
        &[
            (
                "Limits",
                "The ±90° of joint 1 are probably those of the cell that the robot was described for, not the \
                 machine's.",
            ),
            (
                "Source",
                "The source rounds angles to five digits; they were taken as multiples of 90 deg, up to 0.05 mm off \
                 the source at the flange.",
            ),
        ],
    ),
    (
        "Joint velocities taken from",
        &[(
            "Source",
            "Joint speeds are from joint_velocities_dx200.yaml of the package.",
        )],
    ),
    (
        "a1 = 0.740 m, joint 2 at 0.450 m",
        &[(
            "Geometry",
            "a1 = 740 mm and axis 2 at 450 mm are those of the rack-mounted ES165RD, not of the floor-mounted ES165D: \
             check them before use.",
        )],
    ),
];

/// How the pendant's angles are known: the first text is in the remark, the second says it.
const PENDANT: &[(&str, &str)] = &[
    (
        "URDF angles equal the pendant's angles A1..A6",
        "A1 is positive clockwise seen from above; at A2 = -90 and A3 = 90 the upper arm is upright and the forearm \
         level. The robot description has the same angles.",
    ),
    (
        "URDF angles do NOT follow KUKA's pendant",
        "A1 is positive clockwise seen from above; at A2 = -90 and A3 = 90 the upper arm is upright and the forearm \
         level. The robot description has -A1, A2 + 90, A3 - 90, -A4, A5, -A6 instead.",
    ),
    (
        "URDF J3 is decoupled",
        "J3 is the forearm's angle to the horizontal: it stays when J2 moves. The robot description has J3 + J2 \
         instead (fanuc_driver). The controller's world frame lies at the height of axis 2.",
    ),
    (
        "Parallelogram arm",
        "J3 is the forearm's angle against the base: it stays when J2 moves. The robot description has J3 - J2 instead \
         (abb_driver).",
    ),
    (
        "ABB serial arm",
        "The robot description has the same angles.",
    ),
    (
        "motoman_driver converts pulses",
        "S, L, U, R, B, T as in the robot description.",
    ),
    (
        "VAL 3",
        "The robot description has the same angles, as has RobotKinematicsCatalogue 1.1.2.",
    ),
    (
        "turned by 180 deg about z",
        "The robot description has the same angles. The controller's base frame is turned by 180 deg about z.",
    ),
    (
        "Comau joint convention differs",
        "q3 is coupled to q2: the robot description has q3 + q2 instead (RobotKinematicsCatalogue 1.1.2).",
    ),
    (
        "DH frame 0 is panda_link0",
        "The robot description has the same angles. The base frame is panda_link0, the flange panda_link8.",
    ),
];

/// Doubts about the pendant's angles themselves, by what the remark says.
const ANGLES: &[(&str, &str)] = &[
    (
        "not proven for every model",
        "That the pendant shows the angles of the robot description is taken for granted, not proven for this model: \
         compare one pose with the pendant (`stiffarm pose`).",
    ),
    (
        "inferred, not stated",
        "How joint 3 depends on joint 2 is inferred from another catalogue, not stated by the maker: compare one pose \
         with the pendant (`stiffarm pose`).",
    ),
    (
        "derived here by comparison",
        "How the pendant's angles follow from the description's was found by comparison with another catalogue: \
         compare one pose with the pendant (`stiffarm pose`).",
    ),
];

/// What other sources say against a description.
const ELSEWHERE: &[(&str, About, &str)] = &[
    (
        "motoman_gp50",
        "Geometry",
        "a1 is 145 mm here and 150 mm in RobotKinematicsCatalogue 1.1.2: look it up before use.",
    ),
    (
        "abb_irb4600_20_250",
        "Source",
        "RobotKinematicsCatalogue 1.1.2 has d4 and d6 of the 40/2.55 for this variant, too.",
    ),
];

/// The doubts about the robot `name`: what each is about, and the sentence.
pub fn of(name: &str, remarks: &[String], pendant: &str) -> Vec<(String, String)> {
    let mut doubts = Vec::new();
    for remark in remarks {
        match DOUBTS.iter().find(|(text, _)| remark.contains(text)) {
            Some((_, said)) => {
                doubts.extend(said.iter().map(|(a, s)| (a.to_string(), s.to_string())))
            }
            // Nothing is lost: a remark nobody has put into words stands as it is.
            None => doubts.push(("Geometry".to_string(), remark.to_string())),
        }
    }
    let angles = ANGLES.iter().filter(|(text, _)| pendant.contains(text));
    doubts.extend(angles.map(|(_, said)| ("Angles".to_string(), said.to_string())));
    let elsewhere = ELSEWHERE.iter().filter(|(robot, ..)| *robot == name);
    doubts.extend(elsewhere.map(|(_, about, said)| (about.to_string(), said.to_string())));
    doubts
}

/// How the pendant's angles are known, in plain words.
pub fn pendant(remark: &str) -> &str {
    let known = PENDANT.iter().find(|(text, _)| remark.contains(text));
    known.map_or(remark, |(_, said)| said)
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_remark_nobody_put_into_words_is_kept() {
        let doubts = super::of("x", &["Something new.".to_string()], "as they are");
        assert_eq!(
            doubts,
            [("Geometry".to_string(), "Something new.".to_string())]
        );
        assert_eq!(super::pendant("as they are"), "as they are");
    }
}
