//! Tables of text: separators, comments, dates, missing values, and what is refused.

use morsmooth::io::Table;
use proptest::prelude::*;

fn table(text: &str) -> Table {
    Table::parse("t.csv", text.as_bytes()).unwrap()
}

fn refusal<T: std::fmt::Debug>(result: Result<T, morsmooth::io::IoError>) -> String {
    result.unwrap_err().to_string()
}

fn written(table: &Table) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.csv");
    table.write_temporary(&path).unwrap().commit().unwrap();
    std::fs::read_to_string(path).unwrap()
}

#[test]
fn the_separator_is_found_in_the_first_row() {
    for (text, expected) in [
        ("a,b\n1,2.5\n", [1.0, 2.5]),
        ("a;b\n1;2,5\n", [1.0, 2.5]),
        ("a;b\r\n1;2.5\r\n", [1.0, 2.5]),
        ("a\tb\n1\t2,5\n", [1.0, 2.5]),
        ("\u{feff}a,b\n 1 , 2.5 \n", [1.0, 2.5]),
        ("\"a;x\",b\n1,2.5\n", [1.0, 2.5]),
    ] {
        let table = table(text);
        assert_eq!([table.numbers(0).unwrap()[0], table.numbers(1).unwrap()[0]], expected, "{text:?}");
    }
}

#[test]
fn a_first_row_of_numbers_is_no_header() {
    let outline = table("0,0\n1,0\n# the top\n0.5,1e0\n");
    assert_eq!((outline.names(), outline.len()), (&["column_1".to_owned(), "column_2".to_owned()][..], 3));
    assert_eq!(outline.numbers(1).unwrap(), [0.0, 0.0, 1.0]);
    assert_eq!(table("1999-01-04,1.5\n").names()[0], "column_1");
    assert_eq!(table("when,\n1,2\n3,4\n").names(), ["when", "column_2"]);
    assert_eq!(table("x,x\n1,2\n").names(), ["x", "x_2"]);
}

#[test]
fn missing_values_are_known_by_the_words_of_fred_r_and_databases() {
    let table = table("x,y\n1,\n2,.\n3,NaN\n4,NA\n5,null\n6,-\n7,8\n");
    let values = table.numbers(1).unwrap();
    assert!(values[..6].iter().all(|value| value.is_nan()) && values[6] == 8.0);
}

#[test]
fn dates_become_days() {
    let days = |text: &str| table(&format!("d\n{text}\n")).axis(0).map(|axis| axis.values[0]);
    assert_eq!(days("1970-01-02").unwrap(), 1.0);
    assert_eq!(days("1969-12-31").unwrap(), -1.0);
    assert_eq!(days("20000301").unwrap(), days("2000-02-29").unwrap() + 1.0);
    assert_eq!(days("2001-03").unwrap(), days("2001-03-01").unwrap());
    assert_eq!(days("2001-Q3").unwrap(), days("2001-07-01").unwrap());
    assert_eq!(days("1970-01-01T12:00").unwrap(), 0.5);
    assert_eq!(days("1970-01-01 18:00:00").unwrap(), 0.75);
    assert_eq!(days("1970-01-01T12:00:00Z").unwrap(), 0.5);
    assert_eq!(days("1970-01-01T12:00:00+06:00").unwrap(), 0.25);
    assert!(days("2001-02-29").is_err() && days("2001-13").is_err() && days("2001-Q5").is_err());
    // A year alone, and eight digits that are no day, are numbers.
    assert_eq!(days("1999").unwrap(), 1999.0);
    assert_eq!(days("20001399").unwrap(), 20_001_399.0);
}

#[test]
fn refusals_name_line_column_found_and_expected() {
    let parse = |text: &str| refusal(Table::parse("t.csv", text.as_bytes()));
    assert_eq!(parse(""), "t.csv: found no row; expected a table with at least one");
    assert_eq!(parse("# only words\n\n"), "t.csv: found no row; expected a table with at least one");
    assert_eq!(parse("# head\n\na,b\n1,2\n\n# note\n1,2,3\n"), "t.csv, line 7: found 3 cells; expected 2 as in line 3");
    assert_eq!(refusal(Table::parse("t.csv", b"a,b\n1,\xff\n")), "t.csv, line 2, column 2: found \"\u{fffd}\"; expected text in UTF-8");
    let numbers = |text: &str| refusal(table(text).numbers(1));
    assert_eq!(numbers("a,b\n1,2\n1,x\n"), "t.csv, line 3, column 2: found \"x\" in column \"b\"; expected a finite number, or nothing");
    assert_eq!(numbers("a,b\n1,inf\n"), "t.csv, line 2, column 2: found \"inf\" in column \"b\"; expected a finite number, or nothing");
    assert_eq!(
        numbers("a,b\n1,\"2,5\"\n"),
        "t.csv, line 2, column 2: found \"2,5\" in column \"b\"; expected a finite number with a decimal point, or nothing"
    );
    assert_eq!(
        numbers("a;b\n1;2,5\n1;3.5\n"),
        "t.csv, line 3, column 2: found \"3.5\" in column \"b\"; expected the decimal mark ',' of line 2"
    );
    let axis = |text: &str| refusal(table(text).axis(0));
    assert_eq!(
        axis("d,b\nsoon,2\n"),
        "t.csv, line 2, column 1: found \"soon\" in column \"d\"; expected a number or a date such as 2001-01-05, 2001-01-05T12:30 or 2001-01"
    );
    assert_eq!(
        axis("d,b\n2001-01-05,2\n,3\n"),
        "t.csv, line 3, column 1: found \"\" in column \"d\"; expected a date, as in the rows above"
    );
    assert_eq!(
        axis("d,b\n5,2\n2001-01-05,3\n"),
        "t.csv, line 3, column 1: found \"2001-01-05\" in column \"d\"; expected a number, as in the rows above"
    );
}

#[test]
fn what_is_not_touched_is_written_as_it_was() {
    let text = "# source\nday;price;\"a;b\"\n2001-01-05;1,250;\"say \"\"x\"\"\"\n# pause\n2001-01-06;;two\n# end\n";
    let mut table = table(text);
    assert_eq!(written(&table), text);
    table.set_numbers("smooth", &[0.1, f64::NAN]);
    let expected = "# source\nday;price;\"a;b\";smooth\n2001-01-05;1,250;\"say \"\"x\"\"\";0,1\n# pause\n2001-01-06;;two;\n# end\n";
    assert_eq!(written(&table), expected);
    table.set_numbers("smooth", &[1e-7, -2.0]);
    assert_eq!(self::table(&written(&table)).numbers(3).unwrap(), [1e-7, -2.0]);
}

proptest! {
    #[test]
    fn numbers_come_back_bit_for_bit(values in prop::collection::vec(proptest::num::f64::NORMAL | proptest::num::f64::ZERO, 1..40)) {
        let rows: String = (0..values.len()).map(|row| format!("{row};1,5\n")).collect();
        let mut table = table(&format!("x;y\n{rows}"));
        table.set_numbers("z", &values);
        let again = self::table(&written(&table)).numbers(2).unwrap();
        prop_assert!(again.iter().zip(&values).all(|(a, b)| a.to_bits() == b.to_bits()));
    }

    #[test]
    fn damaged_tables_are_refused_or_read_but_never_a_panic(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        if let Ok(table) = Table::parse("t.csv", &bytes) {
            for column in 0..table.width() {
                let _ = (table.numbers(column), table.axis(column));
            }
            prop_assert_eq!(table.names().len(), table.width());
        }
    }
}
