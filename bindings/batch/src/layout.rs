//! Every byte of a batch, described once.

use core::fmt;

/// The first bytes of every batch.
pub const MAGIC: [u8; 4] = *b"FWSB";
/// The version that this build writes, and the newest that it reads.
pub const VERSION: u16 = 1;

/// Where in a batch the version stands (u16).
pub const VERSION_AT: usize = 4;
/// Where in a batch the number of records stands (u32).
pub const N_RECORDS_AT: usize = 6;
/// Where in a batch its whole length in bytes stands (u32).
pub const N_BYTES_AT: usize = 10;
/// Length of a batch's header in bytes; the first record follows.
pub const HEADER_BYTES: usize = 14;
/// Length of a record's header in bytes: code (u8), length of the whole record (u8), time in nanoseconds (i64).
pub const RECORD_HEADER_BYTES: usize = 10;

/// One kind of record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RecordLayout {
    /// The kind's number, the record's first byte; never given to another kind.
    pub code: u8,
    /// The kind's name, in snake case.
    pub name: &'static str,
    /// What the record says, as a sentence.
    pub purpose: &'static str,
    /// What follows the record's header, in this order, without gaps.
    pub fields: &'static [FieldLayout],
}

/// One field of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FieldLayout {
    /// The field's name with its unit, in snake case.
    pub name: &'static str,
    /// How it is written.
    pub encoding: Encoding,
    /// What it says, as a sentence.
    pub purpose: &'static str,
}

/// How a field is written; numbers are little-endian.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Encoding {
    /// An IEEE 754 number of 32 bits.
    F32,
    /// An unsigned number of 16 bits.
    U16,
    /// So many bytes, in the order in which they are printed.
    Bytes(usize),
}

impl Encoding {
    /// Length in bytes.
    pub const fn n_bytes(self) -> usize {
        match self {
            Self::F32 => 4,
            Self::U16 => 2,
            Self::Bytes(n) => n,
        }
    }
}

impl fmt::Display for Encoding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::F32 => f.write_str("f32"),
            Self::U16 => f.write_str("u16"),
            Self::Bytes(n) => write!(f, "{n} bytes"),
        }
    }
}

impl RecordLayout {
    /// Length of the whole record in bytes, its header included.
    pub const fn n_bytes(&self) -> usize {
        let (mut n_bytes, mut k) = (RECORD_HEADER_BYTES, 0);
        while k < self.fields.len() {
            n_bytes += self.fields[k].encoding.n_bytes();
            k += 1;
        }
        n_bytes
    }

    /// The fields with the position of each in the record.
    pub fn placed_fields(&self) -> impl Iterator<Item = (usize, &FieldLayout)> {
        self.fields.iter().scan(RECORD_HEADER_BYTES, |next, field| {
            let at = *next;
            *next += field.encoding.n_bytes();
            Some((at, field))
        })
    }
}

const fn f32_field(name: &'static str, purpose: &'static str) -> FieldLayout {
    FieldLayout { name, encoding: Encoding::F32, purpose }
}

const RSSI: FieldLayout = f32_field("rssi_dbm", "Received signal strength in dBm, -120 to 20.");

/// Specific force.
pub const SPECIFIC_FORCE: RecordLayout = RecordLayout {
    code: 1,
    name: "specific_force",
    purpose: "Specific force in the device frame: +9.81 m/s² on the axis that points up at rest.",
    fields: &[
        f32_field("x_m_s2", "To the right of the screen, in m/s²."),
        f32_field("y_m_s2", "To the top of the screen, in m/s²."),
        f32_field("z_m_s2", "Out of the screen, in m/s²."),
    ],
};

/// Angular rate.
pub const ANGULAR_RATE: RecordLayout = RecordLayout {
    code: 2,
    name: "angular_rate",
    purpose: "Angular rate in the device frame, right-handed.",
    fields: &[
        f32_field("x_rad_s", "About the axis to the right of the screen, in rad/s."),
        f32_field("y_rad_s", "About the axis to the top of the screen, in rad/s."),
        f32_field("z_rad_s", "About the axis out of the screen, in rad/s."),
    ],
};

/// Magnetic field, corrected by the operating system.
pub const MAGNETIC_FIELD: RecordLayout = RecordLayout {
    code: 3,
    name: "magnetic_field",
    purpose: "Magnetic field in the device frame, with the operating system's hard-iron correction applied.",
    fields: &[
        f32_field("x_ut", "To the right of the screen, in µT."),
        f32_field("y_ut", "To the top of the screen, in µT."),
        f32_field("z_ut", "Out of the screen, in µT."),
    ],
};

/// Magnetic field before correction.
pub const UNCALIBRATED_MAGNETIC_FIELD: RecordLayout = RecordLayout {
    code: 4,
    name: "uncalibrated_magnetic_field",
    purpose: "Magnetic field in the device frame before correction, with the operating system's estimate of the bias.",
    fields: &[
        f32_field("x_ut", "To the right of the screen, in µT."),
        f32_field("y_ut", "To the top of the screen, in µT."),
        f32_field("z_ut", "Out of the screen, in µT."),
        f32_field("bias_x_ut", "The bias in x, in µT; field minus bias is corrected."),
        f32_field("bias_y_ut", "The bias in y, in µT."),
        f32_field("bias_z_ut", "The bias in z, in µT."),
    ],
};

/// Air pressure.
pub const PRESSURE: RecordLayout = RecordLayout {
    code: 5,
    name: "pressure",
    purpose: "Air pressure.",
    fields: &[f32_field("pressure_hpa", "Static pressure in hPa, 300 to 1100.")],
};

/// A radio sighting of a BLE sender whose address is known, an iBeacon's included.
pub const BLE_SIGHTING: RecordLayout = RecordLayout {
    code: 6,
    name: "ble_sighting",
    purpose: "A radio sighting: a packet of a BLE sender whose address is known, an iBeacon's included.",
    fields: &[
        RSSI,
        FieldLayout {
            name: "address",
            encoding: Encoding::Bytes(6),
            purpose: "The sender's address, most significant byte first.",
        },
    ],
};

/// A radio sighting of an iBeacon whose address is hidden.
pub const IBEACON_SIGHTING: RecordLayout = RecordLayout {
    code: 7,
    name: "ibeacon_sighting",
    purpose: "A radio sighting: a packet of an iBeacon whose address the platform hides.",
    fields: &[
        RSSI,
        FieldLayout {
            name: "uuid",
            encoding: Encoding::Bytes(16),
            purpose: "The proximity UUID, in the order printed.",
        },
        FieldLayout { name: "major", encoding: Encoding::U16, purpose: "The major number, 0 to 65535." },
        FieldLayout { name: "minor", encoding: Encoding::U16, purpose: "The minor number, 0 to 65535." },
    ],
};

/// A radio sighting of a WiFi access point.
pub const WIFI_SIGHTING: RecordLayout = RecordLayout {
    code: 8,
    name: "wifi_sighting",
    purpose: "A radio sighting: a row of a WiFi scan, stamped with the time at which the access point was heard.",
    fields: &[
        RSSI,
        FieldLayout {
            name: "bssid",
            encoding: Encoding::Bytes(6),
            purpose: "The access point's BSSID, most significant byte first.",
        },
    ],
};

/// A card's advertisement.
pub const CARD_FRAME: RecordLayout = RecordLayout {
    code: 9,
    name: "card_frame",
    purpose: "An ID card's advertisement as a receiver heard it; how strong it was is a radio sighting of the receiver.",
    fields: &[FieldLayout {
        name: "frame",
        encoding: Encoding::Bytes(31),
        purpose: "The whole advertisement, in the order in which it is sent.",
    }],
};

/// Every kind of record, by code.
pub const RECORDS: [RecordLayout; 9] = [
    SPECIFIC_FORCE,
    ANGULAR_RATE,
    MAGNETIC_FIELD,
    UNCALIBRATED_MAGNETIC_FIELD,
    PRESSURE,
    BLE_SIGHTING,
    IBEACON_SIGHTING,
    WIFI_SIGHTING,
    CARD_FRAME,
];

/// The layout as tables in Markdown.
pub fn markdown() -> String {
    use fmt::Write as _;
    let mut text = String::new();
    let mut write = |line: fmt::Arguments<'_>| {
        let written = text.write_fmt(line).and_then(|()| text.write_char('\n'));
        debug_assert!(written.is_ok(), "memory takes every line");
    };
    for record in &RECORDS {
        write(format_args!("### {}: `{}`, {} bytes\n", record.code, record.name, record.n_bytes()));
        write(format_args!("{}\n", record.purpose));
        write(format_args!("| at | as | field | |\n|---|---|---|---|"));
        write(format_args!("| 0 | u8 | `code` | {} |", record.code));
        write(format_args!("| 1 | u8 | `n_bytes` | {} |", record.n_bytes()));
        write(format_args!(
            "| 2 | i64 | `time_ns` | When, on the device's monotonic clock, in nanoseconds. |"
        ));
        for (at, FieldLayout { name, encoding, purpose }) in record.placed_fields() {
            write(format_args!("| {at} | {encoding} | `{name}` | {purpose} |"));
        }
        write(format_args!(""));
    }
    text
}
