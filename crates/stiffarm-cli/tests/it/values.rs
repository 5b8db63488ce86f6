//! Values of options are taken or refused by range and unit.

use insta::assert_snapshot;
use stiffarm::ask::values::{above_zero, number, seed, triple, within};

#[test]
fn a_whole_number_is_refused_with_its_range() {
    let percent = within::<u8>(1..=100);
    assert_eq!(percent("100"), Ok(100));
    for text in ["0", "101", "-1", "1e1", "2.5", "two", "", "99999999999999999999999"] {
        let needed = "a whole number from 1 to 100 is needed";
        assert_eq!(percent(text), Err(needed.to_string()), "{text}");
    }
    assert_eq!(seed()("18446744073709551615"), Ok(u64::MAX));
    let needed = "a whole number from 0 on is needed";
    assert_eq!(seed()("-1"), Err(needed.to_string()));
    assert!(within::<u8>(0..=u64::MAX)("256").is_err());
}

#[test]
fn what_cannot_be_meant_is_refused_with_its_unit() {
    assert_eq!(number("mm")(" 12.5 "), Ok(12.5));
    let shown = number("force_n")("1e300").unwrap_err();
    assert_snapshot!(shown, @"A force of 1e300 N cannot be meant: it must be below 1000000 N");
    for text in ["nan", "inf", "-inf", "1,5", "", "1e999"] {
        assert!(number("mm")(text).is_err(), "{text}");
    }
    assert!(above_zero("mm")("0").is_err());
    assert!(above_zero("mm")("1e-300").is_err());
    assert_eq!(triple("deg")("180, 0,-1e-9"), Ok([180.0, 0.0, -1e-9]));
    assert!(triple("deg")("180,0").is_err());
    assert!(triple("deg")("180,0,1e300").is_err());
}
