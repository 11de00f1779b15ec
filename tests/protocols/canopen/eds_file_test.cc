// SPDX-License-Identifier: Apache-2.0
#include "protocols/canopen/eds_file.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>
#include <stdexcept>
#include <string>

namespace strainwave::protocols::canopen::eds_file_test {
namespace {

constexpr std::string_view kGood = R"([FileInfo]
FileName=invented.eds
; a device that nobody makes

[DeviceInfo]
VendorName=Invented Drives
VendorNumber=0x2A
ProductName = Turner 7
ProductNumber=7
RevisionNumber=0x00010002

[MandatoryObjects]
SupportedObjects=3
1=0x1000
2=0x1001
3=0x1018
[OptionalObjects]
SupportedObjects=4
1=0x1008
2=0x1010
3=0x1016
4=0x1400
[ManufacturerObjects]
SupportedObjects=2
1=0x2000
2=0x2001

[1000]
ParameterName=device type
ObjectType=0x7
DataType=0x0007
AccessType=const
DefaultValue=0x00020192
PDOMapping=0
[1001]
ParameterName=error register
DataType=0x0005
AccessType=RO
PDOMapping=1
[1018]
ParameterName=identity
ObjectType=0x9
SubNumber=2
[1018sub0]
ParameterName=number of entries
DataType=0x0005
AccessType=const
DefaultValue=1
[1018sub1]
ParameterName=vendor
DataType=0x0007
AccessType=ro
DefaultValue=0x2A
[1008]
parametername=name
DATATYPE=0x0009
accesstype=const
DefaultValue=Turner = 7; not a comment
[1010]
ParameterName=store
ObjectType=2
[1016]
ParameterName=heartbeat consumer
ObjectType=0x8
DataType=0x0007
AccessType=rw
CompactSubObj=3
DefaultValue=0
[1016Name]
NrOfEntries=1
2=the master
[1016Value]
NrOfEntries=1
3=0x00010064
[1400]
ParameterName=RPDO
ObjectType=0x9
SubNumber=2
[1400sub0]
ParameterName=highest
DataType=0x0005
AccessType=ro
DefaultValue=1
[1400sub1]
ParameterName=COB-ID
DataType=0x0007
AccessType=rww
DefaultValue=$NODEID+0x200
[2000]
ParameterName=offset
DataType=0x0003
AccessType=rwr
LowLimit=0x8000
HighLimit=100
DefaultValue=-12
PDOMapping=1
[2001]
ParameterName=key
DataType=0x0006
AccessType=wo
DefaultValue=
)";

EdsFile Good() { return ParseEds(kGood, "invented.eds"); }

TEST(ParseEds, ReadsWhoMadeTheDevice) {
  const EdsFile file = Good();
  EXPECT_EQ(file.vendor_name, "Invented Drives");
  EXPECT_EQ(file.product_name, "Turner 7");
  EXPECT_EQ(file.vendor_number, 42U);
  EXPECT_EQ(file.product_number, 7U);
  EXPECT_EQ(file.revision_number, 0x10002U);
}

TEST(ParseEds, ReadsObjectsWithAllTheirKeys) {
  const EdsFile file = Good();
  EXPECT_EQ(file.objects.size(), 3U + 1U + 1U + 4U + 2U + 2U + 1U);
  const EdsObject& offset = file.objects.at({0x2000, 0});
  EXPECT_EQ(offset.name, "offset");
  EXPECT_EQ(offset.type, DataType::kInteger16);
  EXPECT_EQ(offset.access, AccessType::kReadWrite);
  EXPECT_TRUE(offset.mappable);
  EXPECT_EQ(offset.default_value, "-12");
  EXPECT_EQ(offset.low_limit, "0x8000");
  EXPECT_EQ(offset.high_limit, "100");
  EXPECT_EQ(file.objects.at({0x1001, 0}).access, AccessType::kReadOnly);
  EXPECT_TRUE(file.objects.at({0x1001, 0}).mappable);
  EXPECT_EQ(file.objects.at({0x1000, 0}).access, AccessType::kConstant);
  EXPECT_FALSE(file.objects.at({0x1000, 0}).mappable);
  EXPECT_EQ(file.objects.at({0x2001, 0}).access, AccessType::kWriteOnly);
  EXPECT_EQ(file.objects.at({0x1018, 1}).name, "vendor");
  EXPECT_EQ(file.objects.at({0x1400, 1}).default_value, "$NODEID+0x200");
  EXPECT_EQ(file.objects.at({0x1400, 1}).access, AccessType::kReadWrite);
  EXPECT_EQ(file.objects.at({0x1008, 0}).default_value, "Turner = 7; not a comment");
  EXPECT_EQ(file.objects.at({0x1010, 0}).type, DataType::kDomain);
}

TEST(ParseEds, UnfoldsCompactSubObjects) {
  const EdsFile file = Good();
  EXPECT_EQ(file.objects.at({0x1016, 0}).default_value, "3");
  EXPECT_EQ(file.objects.at({0x1016, 0}).type, DataType::kUnsigned8);
  EXPECT_EQ(file.objects.at({0x1016, 1}).name, "heartbeat consumer1");
  EXPECT_EQ(file.objects.at({0x1016, 1}).default_value, "0");
  EXPECT_EQ(file.objects.at({0x1016, 2}).name, "the master");
  EXPECT_EQ(file.objects.at({0x1016, 3}).default_value, "0x00010064");
  EXPECT_EQ(file.objects.at({0x1016, 3}).access, AccessType::kReadWrite);
}

std::string Replaced(std::string_view from, std::string_view to, std::string text = std::string(kGood)) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(ParseEds, TakesEitherEndOfLineCaseAndAByteOrderMark) {
  std::string text = "\xEF\xBB\xBF";
  for (const char c : kGood) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  text = Replaced("[DeviceInfo]", "  [deviceINFO] ", text);
  EXPECT_EQ(ParseEds(text, "x").objects.size(), Good().objects.size());
}

TEST(ParseEds, TakesLinesThatEndInTwoCarriageReturns) {
  std::string text;
  for (const char c : kGood) text += c == '\n' ? std::string("\r\r\n") : std::string(1, c);
  EXPECT_EQ(ParseEds(text, "x").objects.size(), Good().objects.size());
  EXPECT_EQ(ParseEds(text, "x").notes, Good().notes);
}

TEST(ParseEds, TakesWhatADcfFileSetsForTheDefault) {
  const EdsFile file =
      ParseEds(Replaced("DefaultValue=-12\n", "DefaultValue=-12\nParameterValue=99\n"), "x.dcf");
  EXPECT_EQ(file.objects.at({0x2000, 0}).default_value, "99");
  EXPECT_TRUE(file.objects.at({0x2000, 0}).is_set_for_node);
}

// Editors write the key into every section.
TEST(ParseEds, TakesTheDefaultWhereADcfFileSetsNothing) {
  const EdsFile file =
      ParseEds(Replaced("DefaultValue=-12\n", "DefaultValue=-12\nParameterValue=\n"), "x.dcf");
  EXPECT_EQ(file.objects.at({0x2000, 0}).default_value, "-12");
  EXPECT_FALSE(file.objects.at({0x2000, 0}).is_set_for_node);
}

std::string Notes(std::string_view from, std::string_view to) {
  std::string text;
  for (const std::string& note : ParseEds(Replaced(from, to), "bad.eds").notes) {
    text += (text.empty() ? "" : "\n") + note;
  }
  return text;
}

TEST(ParseEds, SaysWhatIsWrongAndWhere) {
  EXPECT_EQ(Notes("AccessType=wo", "AccessType=write"),
            "bad.eds:100:12: note: AccessType 'write' (expected ro, wo, rw, rwr, rww or const)");
  EXPECT_EQ(Notes("DataType=0x0006", "DataType=0x0042"),
            "bad.eds:99:10: note: DataType '0x0042' (expected a type of CiA 301 that is used here)");
  EXPECT_EQ(Notes("DataType=0x0006", "DataType=word"),
            "bad.eds:99:10: note: DataType 'word' (expected a number from 0 to 65535)");
  EXPECT_EQ(Notes("DataType=0x0006\n", ""), "bad.eds:97:1: note: [2001] has no DataType (expected one)");
  EXPECT_EQ(Notes("ParameterName=key\n", ""),
            "bad.eds:97:1: note: [2001] has no ParameterName (expected one)");
  EXPECT_EQ(Notes("DefaultValue=-12", "DefaultValue=30000"),
            "bad.eds:95:14: note: value 30000 is not within the object's limits (expected 0x8000 to 100; "
            "they are not used)");
  EXPECT_EQ(Notes("DefaultValue=-12", "DefaultValue=40000"),
            "bad.eds:95:14: note: DefaultValue '40000' (expected a number from -32768 to 32767)");
  EXPECT_EQ(Notes("DefaultValue=-12", "DefaultValue=-70000"),
            "bad.eds:95:14: note: DefaultValue '-70000' (expected a number from -32768 to 32767)");
  EXPECT_EQ(Notes("HighLimit=100", "HighLimit=-32769"),
            "bad.eds:94:11: note: HighLimit '-32769' (expected a number from -32768 to 32767)");
  EXPECT_EQ(Notes("LowLimit=0x8000", "LowLimit=101"),
            "bad.eds:94:11: note: HighLimit 100 is below LowLimit 101 (expected not below; the object's "
            "limits are not used)");
  EXPECT_EQ(Notes("PDOMapping=1\n[2001]", "PDOMapping=2\n[2001]"),
            "bad.eds:96:12: note: PDOMapping '2' (expected a number from 0 to 1)");
  EXPECT_EQ(
      Notes("ObjectType=2", "ObjectType=5"),
      "bad.eds:61:12: note: ObjectType 0x5 (expected 0x2 domain, 0x7 variable, 0x8 array or 0x9 record)");
  EXPECT_EQ(Notes("SubNumber=2\n[1018sub0]", "SubNumber=3\n[1018sub0]"),
            "bad.eds:43:11: note: SubNumber 3 of object 1018, which has 2 sub-objects (expected 2)");
}

TEST(ParseEds, HoldsListsAndSectionsAgainstEachOther) {
  EXPECT_EQ(Notes("2=0x2001", "2=0x2002"),
            "bad.eds:26:3: note: object 2002 has no section (expected [2002])\n"
            "bad.eds:97:1: note: object 2001 is in none of the lists (expected it in [MandatoryObjects], "
            "[OptionalObjects] or [ManufacturerObjects])");
  EXPECT_EQ(Notes("2=0x2001", "2=0x2000"),
            "bad.eds:26:3: note: object 2000 is listed twice (expected once)\n"
            "bad.eds:97:1: note: object 2001 is in none of the lists (expected it in [MandatoryObjects], "
            "[OptionalObjects] or [ManufacturerObjects])");
  EXPECT_EQ(Notes("SupportedObjects=3", "SupportedObjects=4"),
            "bad.eds:13:18: note: [MandatoryObjects] has no entry 4 (expected 1 to 4)");
}

TEST(ParseEds, SaysWhatIsMissing) {
  EXPECT_EQ(Notes("[FileInfo]", "[File]"),
            "bad.eds:1:1: note: there is no section [FileInfo] (expected one)");
  EXPECT_EQ(Notes("VendorNumber=0x2A\n", ""),
            "bad.eds:5:1: note: [DeviceInfo] has no VendorNumber (expected one)");
  EXPECT_EQ(Notes("VendorNumber=0x2A", "VendorNumber="),
            "bad.eds:7:14: note: VendorNumber '' (expected a number from 0 to 4294967295)");
}

TEST(ParseEds, PassesOverLinesThatAreNoSectionAndNoValue) {
  EXPECT_EQ(Notes("[1000]", "[1000\n[1000]"),
            "bad.eds:28:1: note: not the head of a section (expected '[NAME]')");
  EXPECT_EQ(
      Notes("; a device", " a device"),
      "bad.eds:3:2: note: neither a section nor a value (expected '[NAME]', 'KEY=VALUE' or a comment after "
      "';')");
  EXPECT_EQ(Notes("[FileInfo]", "Early=1\n[FileInfo]"),
            "bad.eds:1:1: note: 'Early' stands before the first section (expected '[NAME]' first)");
  EXPECT_EQ(
      Notes("ProductNumber=7", "ProductNumber=7\nproductnumber=8"),
      "bad.eds:10:1: note: 'productnumber' comes twice in [DeviceInfo] (expected once; first on line 9)");
  EXPECT_EQ(Notes("[2001]\n", "[2001]\nParameterName=a\nDataType=5\nAccessType=ro\n[2001]\n"),
            "bad.eds:101:2: note: section [2001] comes twice (expected once; first on line 97)");
}

TEST(ParseEds, TellsOfEverythingAtOnceInTheOrderOfTheFile) {
  EXPECT_EQ(Notes("[1000]\nParameterName=device type\nObjectType=0x7\nDataType=0x0007\nAccessType=const",
                  "[1000]\nObjectType=7\nDataType=0\nAccessType="),
            "bad.eds:28:1: note: [1000] has no ParameterName (expected one)\n"
            "bad.eds:30:10: note: DataType '0' (expected a type of CiA 301 that is used here)\n"
            "bad.eds:31:12: note: AccessType '' (expected ro, wo, rw, rwr, rww or const)");
}

TEST(ParseEds, ReadsWhateverAFileHolds) {
  std::mt19937 random(3);
  int odd = 0;
  for (int i = 0; i < 5000; ++i) {
    std::string text(kGood);
    for (int j = 0; j < 3; ++j) {
      const std::size_t at = random() % text.size();
      switch (random() % 3) {
        case 0:
          text[at] = static_cast<char>(random() % 256);
          break;
        case 1:
          text.erase(at, random() % 40);
          break;
        default:
          text.insert(at, text.substr(random() % text.size(), random() % 40));
      }
    }
    const EdsFile file = ParseEds(text, "bad.eds");
    odd += file.notes.empty() ? 0 : 1;
    for (const std::string& note : file.notes) ASSERT_TRUE(note.starts_with("bad.eds:")) << note;
  }
  EXPECT_GT(odd, 1000);
}

TEST(ParseEds, RefusesATextThatDescribesNoObject) {
  for (const std::string_view text : {"", "<xml/>", "[FileInfo]\nFileName=a.eds\n"}) {
    try {
      ParseEds(text, "bad.eds");
      ADD_FAILURE() << text;
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(
          std::string(error.what()),
          "bad.eds:1:1: error: no object is described (expected an electronic data sheet, as in CiA 306)");
    }
  }
}

const EdsObject& Object(const EdsFile& file, std::uint16_t index) { return file.objects.at({index, 0}); }

TEST(ParseEds, LeavesOutLimitsThatContradictTheType) {
  const EdsFile file =
      ParseEds(Replaced("DataType=0x0003\nAccessType=rwr\nLowLimit=0x8000\nHighLimit=100\nDefaultValue=-12",
                        "DataType=0x0002\nAccessType=rwr\nLowLimit=0x00\nHighLimit=0xFF\nDefaultValue=3"),
               "bad.eds");
  EXPECT_EQ(Object(file, 0x2000).low_limit, "");
  EXPECT_EQ(Object(file, 0x2000).high_limit, "");
  EXPECT_EQ(Object(file, 0x2000).default_value, "3");
  EXPECT_EQ(Object(file, 0x2000).unclear, "");
  EXPECT_EQ(file.notes, std::vector<std::string>{
                            "bad.eds:94:11: note: HighLimit 0xFF is below LowLimit 0x00 (expected not "
                            "below; the object's limits are not used)"});
}

TEST(ParseEds, TakesWhatDoesNotSayWhichProductItIs) {
  const EdsFile file = ParseEds(Replaced("ProductNumber=7\nRevisionNumber=0x00010002\n", ""), "bad.eds");
  EXPECT_EQ(file.vendor_number, 42U);
  EXPECT_EQ(file.product_number, std::nullopt);
  EXPECT_EQ(file.objects.size(), Good().objects.size());
  EXPECT_EQ(file.notes, (std::vector<std::string>{
                            "bad.eds:5:1: note: [DeviceInfo] has no ProductNumber (expected one)",
                            "bad.eds:5:1: note: [DeviceInfo] has no RevisionNumber (expected one)"}));
}

TEST(ParseEds, MarksAnObjectWhoseTypeOrAccessCannotBeTold) {
  EXPECT_EQ(Object(ParseEds(Replaced("DataType=0x0006", "DataType=0x0042"), "x"), 0x2001).unclear,
            "no DataType that is known here");
  EXPECT_EQ(Object(ParseEds(Replaced("AccessType=wo\n", ""), "x"), 0x2001).unclear,
            "no AccessType that is known here");
}

TEST(ParseEds, TakesObjectsInNoneOfTheListsAndCommentsBehindNumbers) {
  const EdsFile file = ParseEds(
      Replaced("SupportedObjects=2\n1=0x2000\n2=0x2001\n\n[1000]", "SupportedObjects=0 ; none\n\n[1000]"),
      "bad.eds");
  EXPECT_EQ(file.objects.size(), Good().objects.size());
  EXPECT_EQ(file.notes.size(), 2U);  // one an object
  const EdsFile commented = ParseEds(Replaced("HighLimit=100", "HighLimit=0x64 ; of 5"), "bad.eds");
  EXPECT_EQ(Object(commented, 0x2000).high_limit, "0x64");
  EXPECT_TRUE(commented.notes.empty());
}

TEST(EdsNumber, ReadsEachFormOfCia306) {
  EXPECT_EQ(EdsNumber("1234", 5), 1234);
  EXPECT_EQ(EdsNumber("0x7fFF", 5), 0x7FFF);
  EXPECT_EQ(EdsNumber("0X10", 5), 16);
  EXPECT_EQ(EdsNumber("017", 5), 15);
  EXPECT_EQ(EdsNumber("0", 5), 0);
  EXPECT_EQ(EdsNumber("-12", 5), -12);
  EXPECT_EQ(EdsNumber("$NODEID+0x600", 5), 0x605);
  EXPECT_EQ(EdsNumber("$NodeId + 0x180", 0x7F), 0x1FF);
  EXPECT_EQ(EdsNumber("0x180 + $NodeId", 5), 0x185);
  EXPECT_EQ(EdsNumber("$NODEID", 5), 5);
  EXPECT_EQ(EdsNumber("$NODEID+0x80000200", 1), 0x80000201);
  EXPECT_EQ(EdsNumber("-9223372036854775808", 5), std::numeric_limits<std::int64_t>::min());
}

TEST(EdsNumber, SaysNothingForAnythingElse) {
  for (const char* text :
       {"", "-", "0x", "12a", "0x1G", "08", "1 2", "+5", "--5", "1.5", "$NODE+1", "$NODEID-1", "$NODEID+",
        "$NODEID+-1", "+$NODEID", "-1+$NODEID", "1+1", "$NODEID+$NODEID", "9223372036854775808"}) {
    EXPECT_EQ(EdsNumber(text, 5), std::nullopt) << text;
  }
}

}  // namespace
}  // namespace strainwave::protocols::canopen::eds_file_test
