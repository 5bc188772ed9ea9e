use super::{Definition, FigureError, Figures};

static TABLE: [Definition; 5] = [
    Definition::number("a.length_mm", "mm", 0.5, 100.0, "2.5", "a length"),
    Definition::whole("a.lines", "", 1, 4096, "1024", "lines"),
    Definition::switch("a.on", "false", "whether"),
    Definition::choice("a.tip", &["left", "right"], "right", "where"),
    Definition::pairs("a.errors", "mm:um", (0.0, 200.0), (-50.0, 50.0), "errors"),
];
static OTHER: [Definition; 1] = [Definition::number("b.force_n", "N", 0.0, 10.0, "0", "a force")];

fn figures() -> Figures {
    Figures::new(&[&TABLE, &OTHER])
}

#[test]
fn every_kind_is_read_and_given_back() {
    let mut figures = figures();
    let names: Vec<&str> = figures.iter().map(|(definition, _)| definition.name).collect();
    assert_eq!(names, ["a.length_mm", "a.lines", "a.on", "a.tip", "a.errors", "b.force_n"]);
    assert_eq!(figures.pairs("a.errors").unwrap(), &[]);
    for (name, text) in
        [("a.length_mm", "1e1"), ("a.lines", "600"), ("a.on", "true"), ("a.tip", "left"), ("a.errors", "0:0; 100:-3.5")]
    {
        figures.set(name, text).unwrap();
        assert_eq!(figures.iter().find(|(definition, _)| definition.name == name).unwrap().1, text);
    }
    assert_eq!(figures.number("a.length_mm"), Ok(10.0));
    assert_eq!(figures.number("b.force_n"), Ok(0.0));
    assert_eq!(figures.whole("a.lines"), Ok(600));
    assert_eq!(figures.switch("a.on"), Ok(true));
    assert_eq!(figures.word("a.tip"), Ok("left"));
    assert_eq!(figures.pairs("a.errors").unwrap(), &[(0.0, 0.0), (100.0, -3.5)]);
}

#[test]
fn refusals_name_the_figure_and_change_nothing() {
    let mut figures = figures();
    let before: Vec<String> = figures.iter().map(|(_, text)| text.to_owned()).collect();
    for (name, text, message) in [
        ("c", "1", "c: there is no parameter of this name"),
        ("a.length_mm", "", "a.length_mm is a number of mm, such as 2.5"),
        ("a.length_mm", "NaN", "a.length_mm is a number of mm, such as 2.5"),
        ("a.length_mm", "inf", "a.length_mm is a number of mm, such as 2.5"),
        ("a.length_mm", "1e999", "a.length_mm goes from 0.5 to 100 mm"),
        ("a.length_mm", "-1", "a.length_mm goes from 0.5 to 100 mm"),
        ("a.length_mm", "0", "a.length_mm goes from 0.5 to 100 mm"),
        ("a.lines", "0", "a.lines goes from 1 to 4096"),
        ("a.lines", "-3", "a.lines goes from 1 to 4096"),
        ("a.lines", "10.5", "a.lines is a whole number, such as 1024"),
        ("a.on", "yes", "a.on is true or false"),
        ("a.tip", "up", "a.tip is one of left right"),
        ("a.errors", "1,2", "a.errors is none or pairs of mm:um, such as 0:0;100:-3.5"),
        ("a.errors", "0:51", "a.errors goes from none, or 0 to 200:-50 to 50;... mm:um"),
        ("a.errors", "5:1;5:2", "the first number of each pair of a.errors must be above that of the pair before"),
    ] {
        assert_eq!(figures.set(name, text).unwrap_err().to_string(), message);
    }
    let after: Vec<String> = figures.iter().map(|(_, text)| text.to_owned()).collect();
    assert_eq!(after, before);
}

#[test]
fn a_figure_asked_for_as_what_it_is_not_is_unknown() {
    let figures = figures();
    assert_eq!(figures.whole("a.length_mm"), Err(FigureError::Unknown("a.length_mm".into())));
    assert_eq!(figures.number("a.lengthmm"), Err(FigureError::Unknown("a.lengthmm".into())));
}
