//! The Oxford collection's files: what is read, what is refused.
#![allow(clippy::unwrap_used, clippy::panic)]

use std::fs;
use std::path::PathBuf;

use fieldwalk::sensor::{Reading, Sample};
use fieldwalk::time::Timestamp;
use fieldwalk_formats::ilc::LineFault;
use fieldwalk_formats::oxford_steps::{
    AccelerometerReader, Contact, ContactReader, Foot, Placement, find_runs,
};

fn contacts(text: &str) -> Vec<(i64, Foot)> {
    let contacts: Vec<Contact> =
        ContactReader::new(text.as_bytes(), "stepcounter.csv").collect::<Result<_, _>>().unwrap();
    contacts.iter().map(|contact| (contact.time.as_nanos(), contact.foot)).collect()
}

#[test]
fn a_sample_is_time_accuracy_and_three_axes() {
    let text = "263239144953734,2,1.9400482,5.161789,10.162003\r\n263239149989134,-1,1e1, 4.5 ,-0.5\n";
    let samples: Vec<Sample> =
        AccelerometerReader::new(text.as_bytes(), "a").collect::<Result<_, _>>().unwrap();
    let expected = [
        (263_239_144_953_734, [1.940_048_2, 5.161_789, 10.162_003]),
        (263_239_149_989_134, [10.0, 4.5, -0.5]),
    ];
    let read = samples.iter().map(|sample| match sample.reading {
        Reading::SpecificForce(force) => (sample.time.as_nanos(), force),
        ref other => panic!("{other:?}"),
    });
    assert_eq!(read.collect::<Vec<_>>(), expected);
    assert_eq!(samples[0].time, Timestamp::from_nanos(263_239_144_953_734));
}

#[test]
fn a_step_is_a_switch_that_closes() {
    use Foot::{Left, Right};
    // Standing on the left foot at first: no contact. Both at once: left first.
    assert_eq!(
        contacts("1,1,0\n2,0,1\n3,0,1\n4,1,1\n5,0,0\n6,1,1\n"),
        [(2, Right), (4, Left), (6, Left), (6, Right)]
    );
    assert_eq!(contacts("1,1,1\n2,1,1\n"), []);
}

#[test]
fn bad_lines_are_counted_and_the_rest_kept() {
    let text = "1,3,0,0,9.8\n2,3,0,0\n3,3,0,0,nan\nx,3,0,0,9.8\n-4,3,0,0,9.8\n5,3,0,0,z\n6,3,0,0,9.8,1\n\n7,3,0,0,9\n";
    let mut reader = AccelerometerReader::new(text.as_bytes(), "a");
    assert_eq!(reader.by_ref().filter(Result::is_ok).count(), 2);
    let rejections = reader.rejections();
    let count = |fault| rejections.count(fault);
    assert_eq!((count(LineFault::FieldCount), count(LineFault::NotFinite)), (2, 1));
    assert_eq!((count(LineFault::Time), count(LineFault::Number)), (2, 1));
    assert_eq!(rejections.first(), Some((2, LineFault::FieldCount)));

    let mut reader = ContactReader::new(&b"1,0,0\n2,2,0\n3,1,\xff\n4,1,0\n"[..], "s");
    assert_eq!(reader.by_ref().map(|contact| contact.unwrap().time.as_nanos()).collect::<Vec<_>>(), [4]);
    assert_eq!(reader.rejections().count(LineFault::OutOfRange), 1);
    assert_eq!(reader.rejections().count(LineFault::NotUtf8), 1);
}

#[test]
fn another_file_is_refused_with_the_first_bad_line() {
    let error = AccelerometerReader::new(&b"1,0,1\n2,1,0\n"[..], "walk/accelerometer.csv").next().unwrap();
    let message = error.unwrap_err().to_string();
    assert!(
        message.starts_with("walk/accelerometer.csv:1: not the accelerometer.csv of a walk"),
        "{message}"
    );
    assert!(message.contains("199833203154243,3"), "{message}");
    assert!(ContactReader::new(&b""[..], "s").next().unwrap().unwrap_err().message().contains("no row"));
    let endless = "?\n".repeat(10_000);
    let mut reader = ContactReader::new(endless.as_bytes(), "s");
    assert!(reader.next().unwrap().is_err() && reader.next().is_none());
    assert_eq!(reader.rejections().total(), 200);
}

#[test]
fn walks_are_found_below_the_folder_and_sorted() {
    let top = PathBuf::from(env!("CARGO_TARGET_TMPDIR")).join("oxford_runs");
    let _ = fs::remove_dir_all(&top);
    for run in ["b/Pixel_J_Hard_SwingingArm_2", "a/b/Samsung_D_Hard_Backpocket_1", "_Patient_3"] {
        fs::create_dir_all(top.join(run)).unwrap();
        fs::write(top.join(run).join("stepcounter.csv"), "").unwrap();
    }
    fs::create_dir_all(top.join("empty")).unwrap();
    let found: Vec<_> = find_runs(&top).unwrap().into_iter().map(|run| (run.name, run.placement)).collect();
    assert_eq!(
        found,
        [
            ("Pixel_J_Hard_SwingingArm_2".into(), Placement::SwingingArm),
            ("Samsung_D_Hard_Backpocket_1".into(), Placement::BackPocket),
            ("_Patient_3".into(), Placement::Unstated),
        ]
    );
    assert_eq!(find_runs(&top.join("_Patient_3")).unwrap()[0].name, "_Patient_3");
    assert!(find_runs(&top.join("empty")).unwrap_err().to_string().contains("stepcounter.csv"));
    assert!(find_runs(&top.join("nowhere")).unwrap_err().is_not_found());
}
