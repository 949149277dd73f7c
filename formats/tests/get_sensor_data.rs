//! GetSensorData logs, by hand-written lines.

mod text_log;

use fieldwalk::floor_plan::Georeference;
use fieldwalk::sensor::{Reading, TransmitterId};
use fieldwalk_formats::get_sensor_data::GetSensorDataReader;
use fieldwalk_formats::ilc::{LineFault, LineRejections};
use fieldwalk_formats::{FormatError, Record, open_recording};
use proptest::prelude::*;
use text_log::{radio, read_all, sample};

const LOG: &str = "
% LogFile created by the 'GetSensorData2.1' App for Android.
% Accelerometer data: 'ACCE;AppTimestamp(s);SensorTimestamp(s);Acc_X(m/s^2);Acc_Y(m/s^2);Acc_Z(m/s^2);Accuracy(int)'
ACCE;0.017;9563.021;-0.50;1.75;9.75;3
GYRO;0.017;9563.019;-0.375;-0.125;0.0625;3
MAGN;0.019;9563.019;29.5;6.25;-30.0;2
PRES;0.019;9563.019;1013.2500;3
AHRS;0.020;9563.019;10;20;30;0.1;0.2;0.3;3
POSI;1.000;1;40.31352000;-3.48369000;0;0
WIFI;1.250;9564.100;guest;a8:0c:ca:03:9d:d7;2412;-49
WIFI;1.250;9564.100;a;b;a8:0c:ca:03:9d:d8;-50;
BLE4;1.300;iBeacon;e0:78:a3:3d:b5:d6;-93;-59;3;40;9195B3AD-A9D0-4500-85FF-9FB0F65A5201
POSI;2.000;2;40.31361000;-3.48369000;0;0;
";

fn read(bytes: &[u8]) -> (Vec<Record>, LineRejections, Option<FormatError>) {
    read_all(GetSensorDataReader::new(bytes, "log.txt"))
}

#[test]
fn every_kind_of_line_gives_its_record() {
    let (records, rejections, error) = read(LOG.as_bytes());
    assert!(error.is_none() && rejections.total() == 0, "{rejections}");
    let (samples, waypoints): (Vec<_>, Vec<_>) =
        records.iter().copied().partition(|record| matches!(record, Record::Sample(_)));
    let expected = [
        sample(17, Reading::SpecificForce([-0.5, 1.75, 9.75])),
        sample(17, Reading::AngularRate([-0.375, -0.125, 0.0625])),
        sample(19, Reading::MagneticField([29.5, 6.25, -30.0])),
        sample(19, Reading::Pressure { pressure_hpa: 1013.25 }),
        sample(1_250, radio(TransmitterId::WifiBssid([0xa8, 0x0c, 0xca, 3, 0x9d, 0xd7]), -49.0)),
        sample(1_250, radio(TransmitterId::WifiBssid([0xa8, 0x0c, 0xca, 3, 0x9d, 0xd8]), -50.0)),
        sample(1_300, radio(TransmitterId::BleAddress([0xe0, 0x78, 0xa3, 0x3d, 0xb5, 0xd6]), -93.0)),
    ];
    assert_eq!(samples, expected);

    // Without a plan: metres from the first waypoint. 9e-5 degrees of latitude are 10 m.
    let points: Vec<_> = waypoints
        .iter()
        .filter_map(|record| if let Record::Waypoint { point, .. } = record { Some(*point) } else { None })
        .collect();
    assert_eq!((points.len(), points[0].x_m, points[0].y_m, points[1].x_m), (2, 0.0, 0.0, 0.0));
    assert!((points[1].y_m - 10.0).abs() < 0.01, "{points:?}");
}

#[test]
fn a_georeference_puts_waypoints_on_the_floor() {
    let georeference = Georeference {
        origin_latitude_deg: 40.3134,
        origin_longitude_deg: -3.4839,
        latitude_deg_per_m: 1e-5,
        longitude_deg_per_m: 2e-5,
    };
    let mut reader = GetSensorDataReader::new(LOG.as_bytes(), "log.txt").with_georeference(georeference);
    assert_eq!(reader.floor_name(), None);
    let first = reader.by_ref().filter_map(Result::ok).find_map(|record| match record {
        Record::Waypoint { point, .. } => Some(point),
        Record::Sample(_) => None,
    });
    let point = first.expect("a waypoint");
    assert!((point.x_m - 10.5).abs() < 1e-6 && (point.y_m - 12.0).abs() < 1e-6, "{point:?}");
    assert_eq!(reader.floor_name(), Some("F1"));
}

#[test]
fn broken_lines_are_counted_by_cause() {
    let good = "PRES;0.5;1.0;1000;3";
    let cases = [
        ("ACCE;0.1;1.0;-0.5;1.75;9.75", LineFault::FieldCount),
        ("ACCE;0.1;1.0;-0.5;1.75;9.75;3;3", LineFault::FieldCount),
        ("GYRO", LineFault::FieldCount),
        ("GYRO;x;1.0;0;0;0;3", LineFault::Time),
        ("GYRO;1e300;1.0;0;0;0;3", LineFault::Time),
        ("GYRO;0.1;1.0;0;x;0;3", LineFault::Number),
        ("GYRO;0.1;1.0;0;NaN;0;3", LineFault::NotFinite),
        ("WIFI;0.1;1.0;guest;a8:0c;2412;-49", LineFault::Identity),
        ("WIFI;0.1;1.0;guest;a8:0c:ca:03:9d:d7;2412;inf", LineFault::NotFinite),
        ("BLE4;0.1;3;40;-60", LineFault::Identity),
        ("POSI;0.1;1;4431000.0;-3.4;0;0", LineFault::OutOfRange),
        ("SMEL;0.1;1", LineFault::UnknownType),
    ];
    for (line, fault) in cases {
        let (records, rejections, error) = read(format!("{good}\n{line}\r\n{good}").as_bytes());
        assert!(error.is_none() && records.len() == 2, "{line}");
        assert_eq!((rejections.total(), rejections.first()), (1, Some((2, fault))), "{line}");
    }
}

#[test]
fn what_is_no_log_is_refused_with_file_and_line() {
    for (text, line) in [("", 1), ("% only\n% comments\n", 2), ("time,x\n1,2\n", 1)] {
        let (records, _, error) = read(text.as_bytes());
        let error = error.expect("an error");
        assert!(records.is_empty());
        assert!(
            error.to_string().starts_with(&format!("log.txt:{line}: not a GetSensorData log")),
            "{error}"
        );
    }
    let (_, rejections, error) = read("x;1\n".repeat(10_000).as_bytes());
    assert!(error.is_some() && rejections.total() == 200);
}

#[test]
fn a_log_is_opened_by_its_content() {
    let path = std::env::temp_dir().join(format!("fieldwalk-gsd-{}.txt", std::process::id()));
    std::fs::write(&path, LOG).unwrap();
    let mut log = fieldwalk_formats::open_recording(&path).unwrap();
    assert_eq!(log.by_ref().filter(Result::is_ok).count(), 9);
    assert_eq!(log.floor_name(), Some("F1"));
    assert!(log.losses().is_none());
    std::fs::remove_file(&path).unwrap();
}

proptest! {
    #[test]
    fn any_bytes_are_read_without_panic(bytes in proptest::collection::vec(any::<u8>(), 0..400)) {
        read(&bytes);
    }

    #[test]
    fn a_damaged_log_gives_no_more_than_the_log(at in 0..LOG.len(), byte: u8) {
        let mut bytes = LOG.as_bytes().to_vec();
        bytes[at] = byte;
        prop_assert!(read(&bytes).0.len() <= 10);
    }
}

#[test]
fn a_byte_order_mark_hides_no_text_and_what_is_no_log_is_told_what_would_be() {
    let dir = std::env::temp_dir().join(format!("fieldwalk-marks-{}", std::process::id()));
    std::fs::create_dir_all(&dir).unwrap();
    let file = dir.join("log.txt");
    let open = |text: &str| {
        std::fs::write(&file, text).unwrap();
        open_recording(&file).and_then(|mut log| log.next().transpose())
    };
    let log = "% LogFile\nACCE;0.5;0.5;0.0;0.0;9.8;3\n";
    let trace = "1574559495263\tTYPE_WAYPOINT\t81.5\t93.25\n";
    for text in [log, trace] {
        let plain = open(text).unwrap();
        assert!(plain.is_some());
        assert_eq!(open(&format!("\u{feff}{text}")).unwrap(), plain);
    }
    let error = open("name,value\n1,2\n").unwrap_err();
    assert!(error.message().starts_with("of no known format") && error.remedy().contains("MCAP"), "{error}");
    let error = open("time,seconds_elapsed,z,y,x\n1,2,3,4,5\n").unwrap_err();
    assert!(error.message().contains("Sensor Logger") && error.remedy() == "give its folder", "{error}");
    std::fs::remove_dir_all(dir).unwrap();
}
