//! Each slip in a tool path is reported with its place and a hint.

use super::{cell_with, read_with};

/// A file that cannot be read as a path, by its name and text.
const SLIPS: [(&str, &str); 44] = [
    ("a.nc", "G90 G0 X0 Y0 Z5\nG41 D1\nG1 X5\n"),
    ("a.nc", "G90 G0 X0 Y0 Z5\nG1 X5 B30\n"),
    ("a.nc", "G1 X#100 Y0 Z0\n"),
    ("a.nc", "G1 X[1+2] Y0 Z0\n"),
    ("a.nc", "G90 G0 X0 Y0 Z5\nG2 X10 Y0 I4 J0\n"),
    ("a.nc", "G90 G0 X0 Y0 Z5\nG2 X10 Y0 R4\n"),
    ("a.nc", "G90 G0 X0 Y0 Z5\nM98 P100\n"),
    ("a.nc", "G90 G0 X0 Y0 Z5\nG68.2 X0 Y0 Z0 I0 J30 K0\n"),
    ("a.nc", "G90 G0 X0 Y0 Z5\nG1 X1\nG20\n"),
    ("a.nc", "G90 G0 X0 Y0 Z5\nG1 X1 (never ends\n"),
    ("a.nc", "G90 G0 X0 Y0 Z5\nG1 X\n"),
    ("a.mpf", "G1 X0 Y0 Z0\nCYCLE800(1)\n"),
    ("a.mpf", "G1 X0 Y0 Z0 A3=0 B3=0 C3=0\n"),
    ("a.nc", "(nothing)\n"),
    ("a.nc", "G0 X0 Y0 Z5\n"),
    ("a.nc", "G90 G0 X0 Y0 Z5\nG1 X1000000000\n"),
    ("a.cls", "GOTO/1,2,3\nGOTO/1e9,2,3\n"),
    ("a.src", "LIN {X 1e9,Y 2,Z 3,A 0,B 0,C 0}\n"),
    ("a.cls", "GOTO/1,2\n"),
    ("a.cls", "GOTO/1,2,3,0,0,0\n"),
    ("a.cls", "GOTO/1,2,3\nCUTCOM/LEFT\n"),
    ("a.cls", "GOTO/1,2,3\nCIRCLE/0,0,0,0,0,1,5\nGOTO/9,9,9\n"),
    ("a.cls", "GOTO/1,2,3\nCIRCLE/0,0,0,0,0,1,5,0,0,0,0,TIMES,2\n"),
    ("a.apt", "GOTO/1,2,x3\n"),
    ("a.apt", "GOTO/1,2,$\n"),
    ("a.apt", "INDIRV/1,0,0\nTLON,GOFWD/(CIRCLE/0,0,0,5),ON,(LINE/0,0,0,1,1,0)\n"),
    ("a.src", "LIN {X 1,Y 2}\n"),
    ("a.src", "LIN XP7\n"),
    ("a.src", "LIN_REL {X 1}\n"),
    ("a.src", "LIN {X 1,Y 2,Z 3,A 0,B 0,C 0,E1 100}\nLIN {X 2,E1 100.5}\n"),
    ("a.mod", "MoveL Offs(p1,0,0,5),v50,z1,t;\n"),
    ("a.mod", "MoveL [[1,2,3],[0,2,0,0],[0,0,0,0],[9E9,9E9,9E9,9E9,9E9,9E9]],v50,z1,t;\n"),
    ("a.ls", "/PROG A\n/MN\n 1:L PR[1] 50mm/sec FINE ;\n/POS\n/END\n"),
    ("a.cls", "GOTO/1,2,3\nCIRCLE/0,0,0,0,0,1,5\n"),
    ("a.cls", "GOTO/10,5,0,0,2,9\n"),
    ("a.nc", "G90 G0 X0 Y0 Z5\nG51.1 X0\nG1 X5\n"),
    ("a.nc", "G90 G0 X0 Y0 Z5\nG5 P10000\nG5 I1 J1 P1 Q1 X5 Y5\n"),
    ("a.mpf", "G1 X0 Y0 Z0\nG1 AP=45 RP=20\n"),
    ("a.src", "LIN XP3:{X 10}\n"),
    ("a.mod", "PDispSet [[10,0,0],[1,0,0,0]];\n"),
    ("a.mod", "PERS wobjdata w:=[TRUE,TRUE,\"\",[[0,0,0],[1,0,0,0]],[[0,0,0],[1,0,0,0]]];\n"),
    ("a.ls", "/PROG A\n/MN\n 1:L P[1] 50mm/sec FINE Offset,PR[1] ;\n/POS\n/END\n"),
    (
        "a.ls",
        "/PROG A\n/MN\n 1:L P[1] 50mm/sec FINE ;\n 2:L P[2] 50mm/sec FINE ;\n/POS\nP[1]{\n GP1:\n X= 1 mm, Y= 2 mm, Z= 3 mm,\n W= 0 deg, P= 0 deg, R= 0 deg\n GP2:\n UF : 1, UT : 2,\n J1= 12.0 deg\n};\nP[2]{\n GP1:\n X= 2 mm, Y= 2 mm, Z= 3 mm,\n W= 0 deg, P= 0 deg, R= 0 deg\n GP2:\n J1= 13.0 deg\n};\n/END\n",
    ),
    ("a.script", "movel(pose_trans(a, b), a=1)\n"),
];

#[test]
fn slips_are_reported_where_they_are() {
    let cell = cell_with("");
    let said = SLIPS.map(|(name, text)| match read_with(name, text, &cell) {
        Ok(path) => format!("{text}READ: {} points", path.points.len()),
        Err(error) => {
            let place = error.place();
            let at = [place.line, place.column].map(|n| n.map_or("-".to_string(), |n| n.to_string()));
            let hint = error.hint_text().map_or_else(String::new, |hint| format!("\n  {hint}"));
            format!("{text}{name}:{}: {}{hint}", at.join(":"), error.message())
        }
    });
    insta::assert_snapshot!(said.join("\n\n"));
}
