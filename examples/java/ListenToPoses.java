import java.io.IOException;
import lcm.lcm.LCM;
import lcm.lcm.LCMDataInputStream;
import lcm.lcm.LCMSubscriber;
import waymark.pose_t;

/**
 * Prints poses as locd publishes them. Usage: java ListenToPoses LCM_URL COUNT
 * On the class path: lcm.jar (liblcm-java) and waymark-types.jar.
 */
public final class ListenToPoses implements LCMSubscriber {
    private int left;

    private ListenToPoses(int count) {
        left = count;
    }

    public static void main(String[] args) throws Exception {
        LCM lcm = new LCM(args[0]);
        ListenToPoses listener = new ListenToPoses(Integer.parseInt(args[1]));
        lcm.subscribe("WAYMARK_POSE", listener);
        System.out.println("listening");
        System.out.flush();
        listener.waitForAll();
        lcm.close();
    }

    private synchronized void waitForAll() throws InterruptedException {
        while (left > 0) wait();
    }

    @Override
    public synchronized void messageReceived(LCM lcm, String channel, LCMDataInputStream bytes) {
        try {
            pose_t pose = new pose_t(bytes);
            // Only OK is to be relied upon.
            System.out.printf("%s %d: %.3f %.3f %.3f m%n", pose.status == pose_t.OK ? "OK" : "not OK", pose.utime,
                    pose.position[0], pose.position[1], pose.position[2]);
            System.out.flush();
        } catch (IOException damaged) {
            System.err.println(channel + ": " + damaged);
        }
        left -= 1;
        notifyAll();
    }
}
