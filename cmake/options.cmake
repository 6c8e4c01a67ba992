# What a build may do without. A vehicle's computer needs none of these for locd.
option(WAYMARK_TESTS "tests and benchmarks" ON)
option(WAYMARK_REPORT_PAGE "the drawn page of mapbuilder --report: needs Node.js and npm" ON)
option(WAYMARK_JAVA "Java types of the messages, and waymark-spy: needs a JDK and liblcm-java" ON)
option(WAYMARK_LIBCAMERA "the driver of libcamera's cameras, where libcamera is installed" ON)
option(WAYMARK_BAGS "recordings of ROS 2 in mapbuilder import: needs libsqlite3, liblz4 and libzstd" ON)
option(WAYMARK_PRECOMPILED_HEADERS "compile common headers once" ON)
