//! Programs of robots are read as their controllers run them: order, frames, names, and what they cannot say.

use super::{Check, cell_with, codes, positions, read, rounded, stated};
use crate::common::cases::slip;
use nalgebra::Vector3;
use stiffarm::findings::Severity;
use stiffarm_files::program::Language;
use stiffarm_files::tool_path::{Kind, ReadPath, read_tool_path};

/// Base and tool of the cell, as KRL has them.
const BASE: &str = "{X 1500.5,Y -200,Z 612.25,A 35,B -20,C 10}";
const TOOL: &str = "{X 0,Y 0,Z 300,A 0,B 0,C 0}";
const POINT: &str = "{X 10,Y 20,Z 30,A 0,B 0,C 180}";
const TARGET: &str = "[[1,2,3],[0,1,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]]";

fn target(x: f64) -> String {
    TARGET.replacen('1', &x.to_string(), 1)
}

fn krl(src: &str, dat: &str) -> stiffarm::Result<ReadPath> {
    let companion = Some(("a.dat", dat.as_bytes()));
    let kind = Kind::Robot(Language::Krl);
    read_tool_path(kind, ("a.src", src.as_bytes()), companion, &cell_with(""))
}

fn xs(read: &ReadPath) -> Vec<f64> {
    let points = rounded(&stated(read));
    points.into_iter().map(|[x, ..]| x).collect()
}

fn sentence<'a>(read: &'a ReadPath, code: &str) -> &'a str {
    let mut findings = read.findings.iter();
    let first = findings.find(|finding| finding.code.as_str() == code);
    first.map_or("", |finding| finding.sentence.as_str())
}

/// The work object of the cell as RAPID has it, in two frames whose product it is.
fn objects() -> (String, String) {
    let workpiece = cell_with("").work.workpiece;
    let user = nalgebra::Isometry3::new(Vector3::new(0.4, -0.1, 0.2), Vector3::new(0.3, -0.2, 0.1));
    let shown = |pose: &nalgebra::Isometry3<f64>| {
        let (p, q) = (1e3 * pose.translation.vector, pose.rotation);
        format!("[[{:.6},{:.6},{:.6}],[{:.9},{:.9},{:.9},{:.9}]]", p.x, p.y, p.z, q.w, q.i, q.j, q.k)
    };
    (shown(&user), shown(&(user.inverse() * workpiece)))
}

const NONE: &str = "[[0,0,0],[1,0,0,0]]";

fn rapid(frames: [&str; 2], body: &str) -> String {
    let [user, object] = frames;
    format!(
        "MODULE a\nPERS tooldata t:=[TRUE,[[0,0,300],[1,0,0,0]],[5,[0,0,50],[1,0,0,0],0,0,0]];\n\
         PERS wobjdata w:=[FALSE,TRUE,\"\",{user},{object}];\nPERS wobjdata other:=[FALSE,TRUE,\"\",{NONE},{NONE}];\n{body}\nENDMODULE\n"
    )
}

#[test]
fn rapid_takes_the_product_of_user_frame_and_object_frame() -> Check {
    let (user, object) = objects();
    let body = format!("PROC p()\nMoveL {TARGET},v50,z1,t\\WObj:=w;\nENDPROC");
    let path = read("a.mod", &rapid([&user, &object], &body))?;
    assert!(path.findings.is_empty(), "{:?}", path.findings);
    // The other way round is another frame.
    let path = read("a.mod", &rapid([&object, &user], &body))?;
    assert_eq!(codes(&path), ["program-frame"]);
    Ok(())
}

#[test]
fn frames_that_rapid_sets_to_stated_numbers_are_followed() -> Check {
    let (user, object) = objects();
    for set in [
        format!("w:=[FALSE,TRUE,\"\",{user},{object}];"),
        format!("w.uframe:={user};\nw.oframe := {object};"),
        format!("other:=[FALSE,TRUE,\"\",{user},{object}]; w := other;"),
    ] {
        let body = format!("PROC p()\n{set}\nMoveL {TARGET},v50,z1,t,\\WObj:=w;\nENDPROC");
        let path = read("a.mod", &rapid([NONE, NONE], &body))?;
        assert!(path.findings.is_empty(), "{set}: {:?}", path.findings);
    }
    // As it was declared at the first move, as it was set at the second.
    let body = format!(
        "PROC p()\nMoveL {TARGET},v50,z1,t\\WObj:=w;\nw.oframe:={NONE};\nMoveL {TARGET},v50,z1,t\\WObj:=w;\nENDPROC"
    );
    let path = read("a.mod", &rapid([&user, &object], &body))?;
    assert_eq!(codes(&path), ["program-frame", "program-frames"]);
    Ok(())
}

#[test]
fn frames_that_rapid_calculates_are_serious_where_a_move_takes_them() -> Check {
    let (user, object) = objects();
    for set in [
        "w.uframe.trans := shifted;",
        "w.oframe.trans.x := 5;",
        "w := Measured(1);",
        "t.tframe.trans.z:=t.tframe.trans.z+1;",
    ] {
        let body = format!("PROC p()\n{set}\nMoveL {TARGET},v50,z1,t\\WObj:=w;\nENDPROC");
        let path = read("a.mod", &rapid([&user, &object], &body))?;
        assert_eq!(codes(&path), ["frame-assigned"], "{set}");
        assert_eq!(path.findings[0].severity, Severity::Serious);
    }
    let body = format!("PROC p()\nother.uframe.trans.x:=5;\nMoveL {TARGET},v50,z1,t\\WObj:=w;\nENDPROC");
    assert!(read("a.mod", &rapid([&user, &object], &body))?.findings.is_empty());
    Ok(())
}

#[test]
fn rapid_statements_end_at_their_semicolon() -> Check {
    let body = format!(
        "PROC p()\nMoveL {},v50,z1,t; MoveL {},v50,z1,t\\WObj:=w; ! two; of them\nMoveL\n  {}, ! goes on; here\n  v50,z1,\n  t;\n\
         TPWrite \"no; end \"; MoveL\\Conc, {},v50\\V:=20,z1\\Inpos:=inpos50,t;\nENDPROC",
        target(1.0),
        target(2.0),
        target(3.0),
        target(4.0)
    );
    let path = read("a.mod", &rapid([NONE, NONE], &body))?;
    assert_eq!(xs(&path), [1.0, 2.0, 3.0, 4.0]);
    assert_eq!(path.points.last().and_then(|point| point.feed), Some(0.02));
    let lines: Vec<Option<usize>> = stated(&path).iter().map(|point| point.line).collect();
    assert_eq!(lines, [Some(6), Some(6), Some(7), Some(11)]);
    // A semicolon that is missing hides no move.
    let text = format!("MoveL {TARGET},v50,z1,t\nMoveL {TARGET},v50,z1,t;\n");
    let error = read("a.mod", &text).unwrap_err();
    assert_eq!((error.place().line, error.message()), (Some(2), "`;` is missing here."));
    Ok(())
}

#[test]
fn procedures_run_where_they_are_called() -> Check {
    let move_to = |x: f64| format!("MoveL {},v50,z1,t;\n", target(x));
    let (one, two, three) = (move_to(1.0), move_to(2.0), move_to(3.0));
    let text = format!(
        "PROC a()\n{one}ERROR\n{three}ENDPROC\nLOCAL PROC b(num n)\n{two}ENDPROC\nPROC main()\nb 5;\na;\n{three}b 6;\nENDPROC\nPROC c()\n{one}ENDPROC\n"
    );
    let path = read("a.mod", &text)?;
    assert_eq!(xs(&path), [2.0, 1.0, 3.0, 2.0]);
    let features = stated(&path).into_iter().map(|point| point.feature.unwrap_or_default().to_string());
    assert_eq!(features.collect::<Vec<_>>(), ["b", "a", "main", "b"]);
    insta::assert_snapshot!(sentence(&path, "procedure-uncalled"), @"The procedure c (line 15) is called by nothing that is read: its moves are no part of the path.");
    // Without one that is started, nobody knows.
    let path = read("a.mod", &format!("PROC a()\n{one}ENDPROC\nPROC b()\n{two}gripper_on;\nENDPROC\n"))?;
    assert_eq!(xs(&path), [1.0, 2.0]);
    assert!(codes(&path).contains(&"procedure-order"));
    insta::assert_snapshot!(sentence(&path, "not-followed"), @"gripper_on (line 6) is a procedure that is not in the file: what it does is not known here.");
    let path = read("a.mod", &format!("PROC a()\n{one}a;\nENDPROC\n"))?;
    insta::assert_snapshot!(sentence(&path, "not-followed"), @"The procedure a, which calls itself, (line 1) is not followed here.");
    let text = format!(
        "DEF a ( )\nLIN {POINT}\nb ( )\nLIN {{X 3}}\nc ( )\nEND\nDEF b ( )\nLIN {{X 2}}\nEND\nDEF d ( )\nLIN {{X 9}}\nEND\n"
    );
    let path = read("a.src", &text)?;
    assert_eq!(xs(&path), [10.0, 2.0, 3.0]);
    assert_eq!(codes(&path), ["not-followed", "procedure-uncalled"]);
    let pose = |x: f64| format!("movel(p[{x},0.2,0.5,0,3.1,0], a=1, v=0.1)\n");
    let text = format!(
        "def main():\n  def b():\n    if (x):\n    {}    end\n  end\n  {}  b()\nend\nmain()\n",
        pose(0.4),
        pose(0.5)
    );
    let path = read("a.script", &text)?;
    let lines: Vec<Option<usize>> = stated(&path).iter().map(|point| point.line).collect();
    assert_eq!(lines, [Some(7), Some(4)]);
    Ok(())
}

#[test]
fn moves_of_rapid_that_are_not_read_are_refused_by_their_target() {
    let point = format!("CONST robtarget p1:={TARGET};\nMoveL p1,v50,z1,t;\n");
    let mut report = String::new();
    for line in [
        "ArcL p1,v100,seam1,weld1,z10,t;",
        "DrillAt p1;",
        "TriggAbsJ j,v1,t1,fine,t;",
        "EOffsSet [1];",
        "VAR robtarget p2; p2:=Offs(p1,0,0,5); MoveL p2,v50,z1,t;",
    ] {
        let error = read("a.mod", &format!("{point}{line}\n")).expect_err(line);
        assert_eq!(error.place().line, Some(3), "{line}: {error}");
        report += &slip::<()>(line, Err(error));
    }
    insta::assert_snapshot!("moves_of_rapid_not_read", report);
    for line in ["WaitTime 1;", "ConfL\\Off;", "VAR robtarget p2;", "VAR robtarget p2:=CRobT();", "p1.trans.x := 5;"] {
        assert!(read("a.mod", &format!("{point}{line}\n")).is_ok(), "{line}");
    }
}

#[test]
fn krl_takes_bases_and_tools_by_number() -> Check {
    let dat = format!(
        "DEFDAT a\nBASE_DATA[3]={BASE}\nTOOL_DATA[1]={TOOL}\nBASE_DATA[4]={TOOL}\nDECL FRAME F1={BASE}\n\
         DECL E6POS XP1={POINT}\nDECL FDAT FP1={{TOOL_NO 1,BASE_NO 3,IPO_FRAME #BASE,POINT2[] \" \"}}\n\
         DECL FDAT FP2={{TOOL_NO 1,BASE_NO 4,IPO_FRAME #BASE}}\nDECL FDAT FP3={{TOOL_NO 1,BASE_NO 3,IPO_FRAME #TCP}}\nENDDAT\n"
    );
    let after = |head: &str, tail: &str| krl(&format!("DEF a ( )\n{head}\nLIN XP1{tail}\nEND\n"), &dat);
    let right = [
        "BAS (#TOOL,1)\nBAS (#BASE,3)",
        "$TOOL=TOOL_DATA[1]\n$BASE = BASE_DATA[3]",
        "$TOOL=TOOL_DATA[1]\n$BASE = F1",
        "FDAT_ACT=FP1\nBAS(#FRAMES)",
        "FDAT_ACT = {TOOL_NO 1,BASE_NO 3,IPO_FRAME #BASE}",
        "BAS (#BASE,0)\nBAS (#TOOL,0)\nPTP $AXIS_ACT\nFDAT_ACT=FP1",
    ];
    for head in right {
        let path = after(head, "")?;
        assert!(
            path.findings.iter().all(|finding| finding.code.as_str() == "joint-moves"),
            "{head}: {:?}",
            path.findings
        );
    }
    let spline = " WITH $VEL=SVEL_CP(0.1, , LCPDAT1), $TOOL=STOOL2( FP1), $BASE=SBASE( FP1.BASE_NO), $IPO_MODE=SIPO_MODE( FP1.IPO_FRAME)";
    assert!(after("BAS(#BASE,4)", spline)?.findings.is_empty());
    for (head, tail, code) in [
        ("BAS (#TOOL,1)\nBAS (#BASE,4)", "", "program-frame"),
        ("FDAT_ACT=FP2", "", "program-frame"),
        ("FDAT_ACT=FP1\n$BASE.X = 100", "", "frame-assigned"),
        ("FDAT_ACT=FP1\n$TOOL.Z = 100", "", "frame-assigned"),
        ("BASE_DATA[3].X = 5\nFDAT_ACT=FP1", "", "frame-assigned"),
        ("FP1.BASE_NO = 5\nFDAT_ACT=FP1", "", "frame-assigned"),
        ("FDAT_ACT=FP1\nFDAT_ACT.BASE_NO = 2", "", "frame-assigned"),
        ("BAS (#BASE,0)", "", "program-frame"),
        ("XP1 = XP2", "", "point-assigned"),
        ("XP1 = XP1 : {X 10}", "", "point-assigned"),
        ("FDAT_ACT=FP1\nLIN XP1\nBAS(#BASE,4)", "", "program-frames"),
    ] {
        let path = after(head, tail)?;
        assert!(codes(&path).contains(&code), "{head}: {:?}", path.findings);
    }
    let error = after("FDAT_ACT=FP3", "").unwrap_err();
    assert_eq!(error.place().line, Some(2));
    assert!(after("$IPO_MODE=#TCP", "").is_err());
    Ok(())
}

#[test]
fn krl_as_posts_write_it_is_read() -> Check {
    let text = format!(
        "&ACCESS RVP\nDEF part ( )\n\nEXT BAS (BAS_COMMAND :IN,REAL :IN )\n\nBAS (#INITMOV,0 )\n$BWDSTART = FALSE\nPDAT_ACT = PDEFAULT\nBAS(#PTP_DAT)\n\
         FDAT_ACT = {{TOOL_NO 0,BASE_NO 0,IPO_FRAME #BASE}}\nBAS(#FRAMES)\nBAS(#TOOL,0)\nBAS(#BASE,0)\nPTP $AXIS_ACT ; start\n\
         $BASE = {{FRAME: X 1500.5,Y -200,Z 612.25,A 35,B -20,C 10}}\n$TOOL = {{FRAME: X 0,Y 0,Z 300,A 0,B 0,C 0}}\n$VEL.CP = 0.05000\n\
         PTP {{AXIS: A1 0,A2 -90,A3 90,A4 0,A5 10,A6 0}}\nLIN {{X 1,Y 2,Z 3,A 0,B 0,C 180,S 'B010',T 'HFF',E1 0.00000}} C_DIS\nLIN {POINT}\nEND\n"
    );
    let path = read("a.src", &text)?;
    assert_eq!(codes(&path), ["joint-moves"], "{:?}", path.findings);
    assert_eq!(xs(&path), [1.0, 10.0]);
    Ok(())
}

#[test]
fn words_of_krl_moves_stand_for_themselves() -> Check {
    let dat = format!("DEFDAT a\nBASE_DATA[3]={BASE}\nBASE_DATA[4]={TOOL}\nDECL E6POS XP1={POINT}\nENDDAT\n");
    let after = |tail: &str| krl(&format!("DEF a ( )\n$VEL.CP=0.5\nBAS (#BASE,3)\nLIN XP1 C_DIS{tail}\nEND\n"), &dat);
    for (tail, feed, is_other) in [
        ("", Some(0.5), false),
        (" WITH $VEL.CP=0.1", Some(0.1), false),
        (" with $vel.cp = 0.1, $base=base_data[4]", Some(0.1), true),
        // What is calculated is not known.
        (" WITH $VEL.CP=0.5*V", None, false),
        (" With $Base=BASE_DATA[4]", Some(0.5), true),
        (" withdraw $BASE=BASE_DATA[4]", Some(0.5), false),
        (" ; WITH $VEL.CP=0.1, $BASE=BASE_DATA[4]", Some(0.5), false),
    ] {
        let path = after(tail)?;
        assert_eq!(path.points[0].feed, feed, "{tail}");
        assert_eq!(codes(&path).contains(&"program-frame"), is_other, "{tail}: {:?}", path.findings);
    }
    Ok(())
}

#[test]
fn programs_say_the_same_in_small_letters() -> Check {
    let (user, object) = objects();
    let body =
        format!("PROC main()\nVAR speeddata vw:=[20,1,1,1];\nMoveL\\Conc,{TARGET},vw,z1,t\\WObj:=w\\Corr;\nENDPROC");
    let points = [listed(1, "1.0", ""), listed(2, "2.0", ""), listed(3, "3.0", "")];
    let registers = ["1500.5", "-200", "612.25", "10", "-20", "35"].iter().zip(1..);
    let registers: Vec<String> = registers.map(|(number, at)| format!("  PR[9,{at}]={number}")).collect();
    let mut lines: Vec<&str> = registers.iter().map(String::as_str).collect();
    lines.extend(["  UFRAME[3]=PR[9]", "  UFRAME_NUM=3", "L P[1] 50mm/sec FINE Skip,LBL[1]"]);
    lines.extend(["L P[2] 12cm/min FINE Wjnt", "L P[3] 9inch/min FINE COORD"]);
    let job = "MFRAME UF#(2) P00005 P00005\nMOVL C00001 V=46.0 UNTIL IN#(1)=ON\nMOVC C00001 V=1\nMOVC C00002 V=1\n\
               MOVC C00003 V=2 FPT\nMOVC C00004 V=1\nMOVC C00001 V=1\nEND\n";
    let cl_data =
        "TOOL PATH/A,TOOL,T1\nUNITS/MM\nFEDRAT/MMPM,600\nSPINDL/RPM,6000,CLW\nGOTO/1,2,3,0,0,1\nEND-OF-PATH\n";
    for (name, text) in [
        ("a.mod", rapid([&user, &object], &body)),
        ("a.ls", ls(&lines, &points)),
        ("a.jbi", format!("{JOB}{job}")),
        ("a.apt", cl_data.to_string()),
        ("a.nc", "%\nN10 G90 G54 G17 G21\nN20 G0 X1 Y2 Z3 S3000 M3\nG1 X4 F600\nG2 X8 Y2 CR=5\nM30\n".to_string()),
    ] {
        let (path, small) = (read(name, &text)?, read(name, &text.to_ascii_lowercase())?);
        assert_eq!(codes(&path), codes(&small), "{name}: {:?} {:?}", path.findings, small.findings);
        let said = |path: &ReadPath| -> Vec<_> {
            let points = path.points.iter();
            points.map(|point| (point.feed, point.feature.as_ref().map(|name| name.to_ascii_uppercase()))).collect()
        };
        assert_eq!((said(&path), positions(&path)), (said(&small), positions(&small)), "{name}");
    }
    Ok(())
}

#[test]
fn moves_that_fanuc_calculates_are_refused_in_any_case() -> Check {
    let points = [listed(1, "1.0", ""), listed(2, "2.0", ""), listed(3, "3.0", "")];
    let path = read("a.ls", &ls(&["L P[1:no Offset] 50mm/sec FINE", "L P[3:PR[1] 50mm/sec FINE"], &points))?;
    assert_eq!((xs(&path), codes(&path)), (vec![1.0, 3.0], vec![]));
    for word in ["Offset,PR[1]", "offset", "TOOL_OFFSET", "inc", "VOffset,VR[1]", "SEARCH[X]"] {
        let last = format!("L P[3] 50mm/sec FINE {word}");
        let error = read("a.ls", &ls(&["L P[1] 50mm/sec FINE", &last], &points)).unwrap_err();
        assert!(error.message().contains("is calculated by the controller"), "{word}: {}", error.message());
        // The second line of an arc.
        let arc = format!("C P[2]\n    :  P[3] 50mm/sec FINE {word}");
        let error = read("a.ls", &ls(&["L P[1] 50mm/sec FINE", &arc], &points)).unwrap_err();
        assert!(error.message().contains("is calculated by the controller"), "{word}: {}", error.message());
    }
    Ok(())
}

#[test]
fn rapid_as_posts_write_it_is_read() -> Check {
    let (user, object) = objects();
    let text = format!(
        "%%%\n  VERSION:1\n  LANGUAGE:ENGLISH\n%%%\n\nMODULE MOD_part\n    LOCAL PERS tooldata rTool := [TRUE,[[0,0,0],[1,0,0,0]],[2,[0,0,15],[1,0,0,0],0,0,0.005]];\n\
         \x20   LOCAL PERS wobjdata rObj := [FALSE, TRUE, \"\", [[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];\n    VAR speeddata rSpeed := [250,500,5000,1000]; ! speed\n\
         \x20   PROC part()\n        ConfJ \\On;\n        rTool.tframe := [[0, 0, 300],[1,0,0,0]];\n        rObj.uframe := {user};\n        rObj.oframe := {object};\n\
         \x20       rSpeed := [100.00,500,5000,1000];\n        MoveAbsJ [[0,0,0,0,30,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]],rSpeed,z1,rTool,\\WObj:=rObj;\n\
         \x20       MoveL [[1, 2, 3],[0, 1, 0, 0],[0,0,0,0],[9E+09,9E+09,9E+09,9E+09,9E+09,9E+09]],rSpeed,z1,rTool,\\WObj:=rObj;\n    ENDPROC\nENDMODULE\n"
    );
    let path = read("a.mod", &text)?;
    assert_eq!(codes(&path), ["joint-moves"], "{:?}", path.findings);
    assert_eq!((xs(&path), path.points[0].feed), (vec![1.0], Some(0.1)));
    Ok(())
}

/// A point of a FANUC listing with more lines.
fn listed(number: usize, x: &str, more: &str) -> String {
    format!(
        "P[{number}]{{\n   GP1:\n\tUF : 1, UT : 2,\tCONFIG : 'N U T, 0, 0, 0',\n\tX = {x} mm,\tY = 20.0 mm,\tZ = 30.0 mm,\n\tW = 180.0 deg,\tP = 0.0 deg,\tR = 0.0 deg{more}\n}};\n"
    )
}

fn ls(moves: &[&str], points: &[String]) -> String {
    let moves = moves.iter().zip(1..).map(|(line, number)| format!("{number:4}:{line} ;\n"));
    format!("/PROG  A\n/MN\n{}/POS\n{}/END\n", moves.collect::<String>(), points.concat())
}

#[test]
fn fanuc_points_count_where_a_move_goes_there() -> Check {
    let points = [listed(1, "1.0", ""), listed(2, "********", ""), listed(3, "3.0", "")];
    let path =
        read("a.ls", &ls(&["L P[1] 50mm/sec FINE", "  A[875]=ON", "  S[1]=3", "L P[3] 50mm/sec FINE"], &points))?;
    assert!(path.findings.is_empty() && xs(&path) == [1.0, 3.0], "{:?}", path.findings);
    let mut report = String::new();
    for second in ["L P[2] 50mm/sec FINE", "A P[3] 50mm/sec FINE"] {
        report += &slip(second, read("a.ls", &ls(&["L P[1] 50mm/sec FINE", second], &points)));
    }
    insta::assert_snapshot!(report, @"
    » L P[2] 50mm/sec FINE
    [program] a.ls:12:3: P[2] has no X.
      hint: the file is read as FANUC TP, by the ending of its name; docs/paths.md says what is read

    » A P[3] 50mm/sec FINE
    [program] a.ls:4:6: A is a move that is not read here.
      hint: the file is read as FANUC TP, by the ending of its name; docs/paths.md says what is read
    ");
    Ok(())
}

#[test]
fn frames_that_fanuc_sets_are_serious_where_a_move_takes_them() -> Check {
    let points = [listed(1, "1.0", "")];
    let set = ["  PR[9,1]=100", "  UFRAME[3]=PR[9]", "  UFRAME_NUM=3", "L P[1] 50mm/sec FINE"];
    assert_eq!(codes(&read("a.ls", &ls(&set, &points))?), ["frame-assigned", "frame-unknown"]);
    // Stated numbers are followed.
    let numbers = |name: &str, numbers: [f64; 6]| {
        let lines = numbers.into_iter().zip(1..);
        let lines = lines.map(|(number, at)| format!("  PR[{name},{at}]={number}"));
        lines.collect::<Vec<_>>()
    };
    let mut lines = numbers("95", [1500.5, -200.0, 612.25, 10.0, -20.0, 35.0]);
    lines.extend(["  UFRAME[9]=PR[95]".into(), "  UFRAME_NUM=9".into()]);
    lines.extend(numbers("95", [0.0, 0.0, 300.0, 0.0, 0.0, 0.0]));
    lines.extend(["  UTOOL[9]=PR[95]".into(), "  UTOOL_NUM=9".into()]);
    lines.push("L P[1] 50mm/sec FINE".into());
    let texts: Vec<&str> = lines.iter().map(String::as_str).collect();
    let path = read("a.ls", &ls(&texts, &points))?;
    assert!(path.findings.is_empty(), "{:?}", path.findings);
    lines[5] = "  PR[95,6]=R[1]".into();
    let texts: Vec<&str> = lines.iter().map(String::as_str).collect();
    assert!(codes(&read("a.ls", &ls(&texts, &points))?).contains(&"frame-assigned"));
    let other = ["  UTOOL[4]=PR[9]", "  UTOOL_NUM=2", "L P[1] 50mm/sec FINE", "  UFRAME_NUM=3"];
    assert_eq!(codes(&read("a.ls", &ls(&other, &points))?), ["frame-unknown"]);
    Ok(())
}

#[test]
fn poses_of_urscript_are_those_of_their_time() -> Check {
    let text = "P1=p[0.4,0.1,0.2,0,3.1,0]\nmovel(P1)\nP1=p[0.5,0.1,0.2,0,3.1,0]\nmovel(P1)\n";
    let path = read("a.script", text)?;
    let base = *cell_with("").setup.robot.controller_base();
    let x = |point: &stiffarm::model::path::PathPoint| match &point.target {
        stiffarm::model::path::PathTarget::Pose(pose) => (base.inverse() * pose).translation.vector.x,
        _ => f64::NAN,
    };
    let all: Vec<f64> = stated(&path).iter().map(x).collect();
    assert!((all[0] - 0.4).abs() < 1e-9 && (all[1] - 0.5).abs() < 1e-9, "{all:?}");
    let text = "P1=p[0.4,0.1,0.2,0,3.1,0]\nP1[2]=0.3\nmovel(P1)\n";
    assert_eq!(codes(&read("a.script", text)?), ["point-assigned"]);
    let tcp = |z: f64| format!("set_tcp(p[0,0,{z},0,0,0])\n");
    let go = "movel(p[0.4,0.1,0.2,0,3.1,0])\n";
    assert!(read("a.script", &format!("{}{go}{}{go}", tcp(0.3), tcp(0.3)))?.findings.is_empty());
    let twice = read("a.script", &format!("{}{go}{}{go}", tcp(0.3), tcp(0.31)))?;
    assert_eq!(codes(&twice), ["program-frame", "program-frames"]);
    for line in [
        "speedl([0,0,1,0,0,0], 0.5, 1)",
        "servoc(p[0.4,0,0,0,3,0])",
        "path_offset_set(p[0,0,0,0,0,0], 1)",
        "optimovel(p[0.4,0,0,0,3,0])",
        "movec(p[0.4,0.1,0.2,0,0,0], p[0.5,0.1,0.2,0,3.1,0], mode=1)",
        "movec(p[0.4,0.1,0.2,0,0,0], p[0.5,0.1,0.2,0,3.1,0], 1, 0.1, 0, 1)",
    ] {
        assert!(read("a.script", &format!("{go}{line}\n")).is_err(), "{line}");
    }
    // The turn of the point on the way is not the controller's.
    let text = "movel(p[0.4,0.1,0.2,0,3.1,0])\nmovec(p[0.5,0.2,0.2,0,0,0], p[0.6,0.1,0.2,0,3.1,0], 1, 0.1)\n";
    let path = read("a.script", text)?;
    let turned = path.points.iter().map(|point| match &point.target {
        stiffarm::model::path::PathTarget::Pose(pose) => (base.inverse() * pose)
            .rotation
            .angle_to(&nalgebra::UnitQuaternion::from_scaled_axis(Vector3::new(0.0, 3.1, 0.0))),
        _ => f64::NAN,
    });
    assert!(turned.fold(0.0, f64::max) < 1e-9);
    Ok(())
}

#[test]
fn external_axes_that_stand_still_are_part_of_the_base() -> Check {
    let target = |eax: &str| format!("[[1,2,3],[0,1,0,0],[0,0,0,0],[{eax},9E9,9E9,9E9,9E9,9E9]]");
    let group = |at: &str| format!("\n   GP2:\n\tUF : 0, UT : 1,\n\tJ1= {at} mm");
    let track = |at: &str| format!(",\n\tE1= {at} mm");
    let moves = ["L P[1] 50mm/sec FINE", "L P[2] 50mm/sec FINE"];
    let two =
        |a: String, b: String| ls(&moves, &[listed(1, "1.0", &a), listed(2, "2.0", &b), listed(3, "3.0", &group("7"))]);
    let with = |at: &str, other: &str| {
        [
            ("a.src", format!("LIN {{X 1,Y 2,Z 3,A 0,B 0,C 180,E1 {at}}}\nLIN {{X 2,E1 {other}}}\n")),
            ("a.mod", format!("MoveL {},v50,z1,t;\nMoveL {},v50,z1,t;\n", target(at), target(other))),
            ("a.ls", two(group(at), group(other))),
            ("a.ls", two(track(at), track(other))),
        ]
    };
    let mut report = String::new();
    for (name, text) in with("1000", "1000.0") {
        report += &format!("» {name}\n{}\n\n", sentence(&read(name, &text)?, "external-axis"));
    }
    for (name, text) in with("0", "0.0") {
        assert_eq!(sentence(&read(name, &text)?, "external-axis"), "");
    }
    for (name, text) in with("0", "100") {
        report += &slip(&format!("{name}, moved"), read(name, &text));
    }
    insta::assert_snapshot!("external_axes", report);
    // What a line leaves out stands where the last move left it.
    let text = format!("LIN {POINT}\nPTP {{A1 0,A2 -90,A3 90,A4 0,A5 0,A6 0,E1 500}}\nLIN {{X 5}}\n");
    assert!(read("a.src", &text).is_err());
    Ok(())
}

const JOB: &str = "/JOB\n//NAME PART\n//POS\n///NPOS 6,0,0,1,0,0\n///TOOL 1\n///POSTYPE PULSE\n///PULSE\nC00000=1,2,3,4,5,6\n///USER 2\n///POSTYPE USER\n///RECTAN\n\
                   ///RCONF 1,0,0,0,0,0,0,0\nC00001=10.000,0.000,0.000,180.00,0.00,0.00\nC00002=0,10,0,180,0,0\nC00003=-10,0,0,180,0,0\nC00004=-10,5,7,180,0,30\nP00005=1,2,3,4,5,6\n\
                   //INST\n///DATE 2026/01/01 10:00\n///ATTR SC,RW,RJ\n///GROUP1 RB1\nNOP\nMOVJ C00000 VJ=50.00\n";

#[test]
fn inform_jobs_with_poses_are_paths() -> Check {
    let job = |lines: &str| read("a.jbi", &format!("{JOB}{lines}END\n"));
    let path = job(
        "MOVL C00001 V=46.0\nMOVC C00001 V=46.0 PL=0\n'in between\nDOUT OT#(1) ON\nMOVC C00002 V=46.0\nMOVC C00003 V=46.0\nMOVL C00004 V=11.5\n",
    )?;
    let all = positions(&path);
    assert_eq!((all[0], all[all.len() - 1]), ([10.0, 0.0, 0.0], [-10.0, 5.0, 7.0]));
    let arc = all.iter().take_while(|p| p[2] == 0.0);
    assert!(arc.clone().count() > 10 && arc.clone().all(|p| (p[0].hypot(p[1]) - 10.0).abs() < 1e-6 && p[1] > -1e-6));
    assert_eq!((path.points[0].feed, path.points.last().and_then(|point| point.feed)), (Some(0.046), Some(0.0115)));
    let mut said = codes(&path);
    said.sort_unstable();
    assert_eq!(said, ["frame-unknown", "frame-unknown", "joint-moves", "speed-unit"]);
    assert!(path.findings.iter().all(|finding| finding.severity == Severity::Note));
    // The turns are about fixed x, y, z.
    let table = "x_mm,y_mm,z_mm,roll_deg,pitch_deg,yaw_deg\n-10,5,7,180,0,30\n";
    let table = stiffarm_files::table::read_path(table.as_bytes(), "a.csv", &cell_with(""), None)?;
    assert!(super::apart(&[path.points.last().unwrap().clone()], &table.points).1 < 1e-9);
    // It is written with other numbers, and where nothing moves with the same bytes.
    let text = format!("{JOB}MOVL C00001 V=1\nMOVL C00004 V=1\nEND\n");
    let path = read("a.jbi", &text)?;
    let same = path.program.write(&path.points, &path.points)?;
    assert_eq!(same.files[0].1, text.as_bytes());
    let shift = Vector3::new(0.5, -0.25, 0.125);
    let moved = super::commanded(&path, |_, _| shift, |_, _| Vector3::zeros());
    let written = path.program.write(&path.points, &moved)?;
    let again = read("a.jbi", std::str::from_utf8(&written.files[0].1)?)?;
    assert!(super::apart(&stated(&again)[..1], &moved[..1]).0 < 1e-6);
    // Two arcs that follow each other.
    let two = "MOVC C00001 V=1\nMOVC C00002 V=1\nMOVC C00003 V=1 FPT\nMOVC C00004 V=1\nMOVC C00001 V=1\n";
    assert!(job(two)?.points.len() > 20);
    for (lines, line) in [
        ("MOVC C00001 V=1\nMOVC C00002 V=1\n", 26),
        ("MOVC C00001 V=1\nMOVC C00002 V=1\nMOVL C00004 V=1\n", 26),
        ("MOVC C00001 V=1\nMOVC C00002 V=1\nMOVC C00003 V=1\nMOVC C00004 V=1\n", 27),
        ("MOVS C00001 V=1\n", 24),
        ("MOVL P00005 V=1\n", 24),
        ("MOVL C00000 V=1\n", 24),
        ("SFTON P00005\nMOVL C00001 V=1\n", 24),
        ("+MOVL C00001 V=1\n", 24),
    ] {
        let error = job(lines).unwrap_err();
        assert_eq!(error.place().line, Some(line), "{lines}: {}", error.message());
    }
    let path = job("MFRAME UF#(2) P00005 P00005 P00005\nMOVL C00001 V=1\nCALL JOB:B\n")?;
    assert!(codes(&path).contains(&"frame-assigned") && codes(&path).contains(&"not-followed"));
    let base = format!("{JOB}MOVL C00001 V=1\n").replace("POSTYPE USER", "POSTYPE BASE");
    assert!(codes(&read("a.JBI", &base)?).contains(&"program-frame"));
    assert!(read("a.jbi", &base.replace("POSTYPE BASE", "POSTYPE TOOL")).is_err());
    Ok(())
}
