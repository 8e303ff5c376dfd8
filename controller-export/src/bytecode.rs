//! The bytecode of the standard firmware, shared by the assembler and the emulator.
//!
//! Source: `c_cmd_bytecodes.h` and `c_cmd.h` of the LEGO firmware 1.29 and programs of the compiler nbc.

/// The first 14 bytes of a program.
pub(crate) const MAGIC: [u8; 14] = *b"MindstormsNXT\0";
/// Bytes of a program's header.
pub(crate) const HEADER_BYTES: usize = 38;
/// Means "no operand", "no dope vector" or "no offset".
pub(crate) const NONE: u16 = 0xFFFF;
/// Bytes of a dope vector: five 16-bit fields.
pub(crate) const DOPE_VECTOR_BYTES: usize = 10;
/// Memory of one clump record on the brick.
pub(crate) const CLUMP_RECORD_BYTES: usize = 28;
/// The flag of a dataspace entry whose value is zero and is not stored.
pub(crate) const DEFAULT_ZERO: u8 = 1;
/// The size nibble of an instruction whose size is in its second word.
pub(crate) const VARIABLE_SIZE: u16 = 0xE;
/// The bit of an instruction's first word that marks a short form.
pub(crate) const SHORT_FORM: u16 = 1 << 11;

/// Declares an enum with numbered variants and its conversion from a number.
macro_rules! numbered {
    ($(#[$doc:meta])* $name:ident: $number:ty { $($(#[$variant_doc:meta])* $variant:ident = $value:expr,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        #[repr($number)]
        pub(crate) enum $name { $($(#[$variant_doc])* $variant = $value,)* }

        impl $name {
            pub(crate) fn from_number(number: $number) -> Option<Self> {
                match number {
                    $($value => Some($name::$variant),)*
                    _ => None,
                }
            }
        }
    };
}

numbered! {
    /// The type of a dataspace entry.
    Type: u8 {
        Void = 0,
        U8 = 1,
        I8 = 2,
        U16 = 3,
        I16 = 4,
        U32 = 5,
        I32 = 6,
        Array = 7,
        Cluster = 8,
        Mutex = 9,
        Float = 10,
    }
}

numbered! {
    /// An instruction.
    Op: u8 {
        Add = 0x00,
        Sub = 0x01,
        Neg = 0x02,
        Mul = 0x03,
        Div = 0x04,
        Mod = 0x05,
        And = 0x06,
        Or = 0x07,
        Xor = 0x08,
        Not = 0x09,
        Cmp = 0x11,
        Tst = 0x12,
        Index = 0x15,
        Replace = 0x16,
        ArrSize = 0x17,
        ArrBuild = 0x18,
        ArrSubset = 0x19,
        ArrInit = 0x1A,
        Mov = 0x1B,
        Set = 0x1C,
        Flatten = 0x1D,
        Unflatten = 0x1E,
        NumToString = 0x1F,
        StringToNum = 0x20,
        StrCat = 0x21,
        StrSubset = 0x22,
        StrToByteArr = 0x23,
        ByteArrToStr = 0x24,
        Jmp = 0x25,
        BrCmp = 0x26,
        BrTst = 0x27,
        Syscall = 0x28,
        Stop = 0x29,
        FinClump = 0x2A,
        FinClumpImmed = 0x2B,
        Acquire = 0x2C,
        Release = 0x2D,
        SubCall = 0x2E,
        SubRet = 0x2F,
        SetIn = 0x30,
        SetOut = 0x31,
        GetIn = 0x32,
        GetOut = 0x33,
        Wait = 0x34,
        GetTick = 0x35,
        Sqrt = 0x36,
        Abs = 0x37,
    }
}

numbered! {
    /// How two values are compared.
    Comparison: u8 {
        Less = 0,
        Greater = 1,
        LessOrEqual = 2,
        GreaterOrEqual = 3,
        Equal = 4,
        NotEqual = 5,
    }
}

numbered! {
    /// A system call of the firmware.
    Syscall: u16 {
        FileOpenRead = 0,
        FileOpenWrite = 1,
        FileOpenAppend = 2,
        FileRead = 3,
        FileWrite = 4,
        FileClose = 5,
        FileResolveHandle = 6,
        FileRename = 7,
        FileDelete = 8,
        SoundPlayFile = 9,
        SoundPlayTone = 10,
        SoundGetState = 11,
        SoundSetState = 12,
        DrawText = 13,
        DrawPoint = 14,
        DrawLine = 15,
        DrawCircle = 16,
        DrawRect = 17,
        DrawPicture = 18,
        SetScreenMode = 19,
        ReadButton = 20,
        CommLsWrite = 21,
        CommLsRead = 22,
        CommLsCheckStatus = 23,
        RandomNumber = 24,
        GetStartTick = 25,
        MessageWrite = 26,
        MessageRead = 27,
        CommBtCheckStatus = 28,
        CommBtWrite = 29,
        CommBtRead = 30,
        KeepAlive = 31,
        IoMapRead = 32,
        IoMapWrite = 33,
        ColorSensorRead = 34,
        CommBtOnOff = 35,
        CommBtConnection = 36,
        CommHsWrite = 37,
        CommHsRead = 38,
        CommHsCheckStatus = 39,
        ReadSemData = 40,
        WriteSemData = 41,
        ComputeCalibValue = 42,
        UpdateCalibCacheInfo = 43,
        DatalogWrite = 44,
        DatalogGetTimes = 45,
        SetSleepTimeout = 46,
        ListFiles = 47,
    }
}

numbered! {
    /// A field of an input (a sensor port).
    InputField: u16 {
        Type = 0,
        Mode = 1,
        AdRaw = 2,
        NormRaw = 3,
        Scaled = 4,
        InvalidData = 5,
    }
}

numbered! {
    /// A field of an output (a motor port).
    OutputField: u16 {
        Flags = 0,
        Mode = 1,
        Power = 2,
        ActualSpeed = 3,
        TachoCount = 4,
        TachoLimit = 5,
        RunState = 6,
        TurnRatio = 7,
        RegulationMode = 8,
        Overload = 9,
        PValue = 10,
        IValue = 11,
        DValue = 12,
        BlockTachoCount = 13,
        RotationCount = 14,
        Options = 15,
        MaxSpeed = 16,
        MaxAcceleration = 17,
    }
}

/// Bits of [`OutputField::Flags`]: which fields of an output the firmware applies.
pub(crate) mod update {
    pub(crate) const MODE: u8 = 0x01;
    pub(crate) const SPEED: u8 = 0x02;
    pub(crate) const TACHO_LIMIT: u8 = 0x04;
    pub(crate) const RESET_COUNT: u8 = 0x08;
    pub(crate) const RESET_BLOCK_COUNT: u8 = 0x20;
    pub(crate) const RESET_ROTATION_COUNT: u8 = 0x40;
}

/// Bits of [`OutputField::Mode`].
pub(crate) mod mode {
    pub(crate) const MOTOR_ON: u8 = 0x01;
    pub(crate) const BRAKE: u8 = 0x02;
    pub(crate) const REGULATED: u8 = 0x04;
}

/// Values of [`OutputField::RegulationMode`].
pub(crate) mod regulation_mode {
    pub(crate) const SPEED: u8 = 0x01;
    pub(crate) const SYNC: u8 = 0x02;
}

/// The value of [`OutputField::RunState`] for a motor that is idle.
pub(crate) const RUN_STATE_IDLE: u8 = 0x00;
/// The value of [`OutputField::RunState`] for a motor that runs.
pub(crate) const RUN_STATE_RUNNING: u8 = 0x20;
/// The value of [`InputField::Type`] for a digital sensor with 9 V supply.
pub(crate) const SENSOR_LOW_SPEED_9V: u8 = 11;
/// The value of [`InputField::Type`] for a digital sensor without supply.
pub(crate) const SENSOR_LOW_SPEED: u8 = 10;

/// The value of [`InputField::Type`] for a touch sensor.
pub(crate) const SENSOR_SWITCH: u8 = 1;
/// The orange button.
pub(crate) const CENTER_BUTTON: u16 = 3;

/// Bits of [`InputField::Mode`]: how a value is scaled.
pub(crate) mod input_mode {
    pub(crate) const MASK: u8 = 0xE0;
    pub(crate) const RAW: u8 = 0x00;
    pub(crate) const BOOLEAN: u8 = 0x20;
}

/// Status codes of the calls for digital sensors and for other bricks.
pub(crate) mod comm {
    pub(crate) const OK: i8 = 0;
    pub(crate) const PENDING: i8 = 32;
    pub(crate) const NOT_READY: i8 = -32;
    pub(crate) const INVALID_PORT: i8 = -33;
    pub(crate) const BUS_ERROR: i8 = -35;
    pub(crate) const INVALID_SIZE: i8 = -19;
    pub(crate) const INVALID_CONNECTION: i8 = -16;
    pub(crate) const INVALID_QUEUE: i8 = -18;
    pub(crate) const EMPTY_MAILBOX: i8 = 64;
}

/// The ultrasonic sensor's address on its bus.
pub(crate) const SONAR_ADDRESS: u8 = 0x02;
/// The register that holds the sensor's type, "Sonar".
pub(crate) const SONAR_TYPE: u8 = 0x10;
/// The register that holds the distance of the nearest echo in cm.
pub(crate) const SONAR_FIRST_ECHO: u8 = 0x42;

impl Type {
    /// Returns the size of a value in bytes. The value of an array is the index of its dope vector.
    pub(crate) fn bytes(self) -> usize {
        match self {
            Type::Void | Type::Cluster => 0,
            Type::U8 | Type::I8 => 1,
            Type::U16 | Type::I16 | Type::Array => 2,
            Type::U32 | Type::I32 | Type::Mutex | Type::Float => 4,
        }
    }

    pub(crate) fn is_aggregate(self) -> bool {
        matches!(self, Type::Array | Type::Cluster)
    }

    pub(crate) fn is_integer(self) -> bool {
        matches!(self, Type::U8 | Type::I8 | Type::U16 | Type::I16 | Type::U32 | Type::I32)
    }

    pub(crate) fn is_signed(self) -> bool {
        matches!(self, Type::I8 | Type::I16 | Type::I32)
    }
}

impl Op {
    /// Returns the size of the instruction in bytes, or `None` if it varies.
    pub(crate) fn bytes(self) -> Option<u16> {
        use Op::*;
        match self {
            Jmp | Stop | FinClumpImmed | Acquire | Release | SubRet | GetTick => Some(4),
            Neg | Not | Tst | ArrSize | Mov | Set | Flatten | NumToString | StrToByteArr | ByteArrToStr | BrTst
            | Syscall | FinClump | SubCall | Wait | Sqrt | Abs => Some(6),
            Add | Sub | Mul | Div | Mod | And | Or | Xor | Cmp | Index | ArrInit | BrCmp | SetIn | GetIn | GetOut => {
                Some(8)
            }
            Replace | ArrSubset | Unflatten | StrSubset => Some(10),
            StringToNum => Some(12),
            ArrBuild | StrCat | SetOut => None,
        }
    }
}

impl Comparison {
    /// Returns whether values in this order satisfy the comparison. Unordered values are only unequal.
    pub(crate) fn holds(self, order: Option<std::cmp::Ordering>) -> bool {
        use std::cmp::Ordering::{Equal, Greater, Less};
        match self {
            Comparison::Less => order == Some(Less),
            Comparison::Greater => order == Some(Greater),
            Comparison::LessOrEqual => matches!(order, Some(Less | Equal)),
            Comparison::GreaterOrEqual => matches!(order, Some(Greater | Equal)),
            Comparison::Equal => order == Some(Equal),
            Comparison::NotEqual => order != Some(Equal),
        }
    }
}
